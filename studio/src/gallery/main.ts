// The gallery of the documentation: the mechanisms of the catalogue in motion, without a server of ours.

import { mount } from 'svelte';
import Gallery from './Gallery.svelte';
import type { Entry } from './recording';
import { bookTheme } from '../playground/theme';

const target = document.getElementById('gallery-view');
if (target) {
  try {
    const folder = target.dataset.folder ?? '.';
    const read = async (name: string) => {
      const answer = await fetch(`${folder}/${name}.json`);
      if (!answer.ok) throw new Error(`${folder}/${name}.json: ${answer.status}`);
      return answer.json();
    };
    const entries = (await read('index')) as Entry[];
    target.replaceChildren();
    mount(Gallery, { target, props: { entries, read, theme: bookTheme } });
  } catch (error) {
    target.textContent = `The gallery needs WebGL and a server of files: ${error instanceof Error ? error.message : String(error)}`;
  }
}
