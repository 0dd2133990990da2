import { mount } from 'svelte';
import App from './App.svelte';
import './style.css';
import './print.css';

const target = document.getElementById('app') as HTMLElement;
// The note that the page is being loaded.
target.replaceChildren();
mount(App, { target });
