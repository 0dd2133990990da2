// The playground of the documentation: mounts into the start page, which is there without it too.

import { mount } from 'svelte';
import wasm from '../../../crates/jointplay-wasm/js/dist/jointplay.wasm?url';
import paper from '../../../crates/jointplay-wasm/js/paper.json';
import { load, type Geometry } from '../../../crates/jointplay-wasm/js/jointplay';
import Playground from './Playground.svelte';
import { bookTheme } from './theme';

const target = document.getElementById('playground');
if (target) {
  try {
    const module = await load(fetch(wasm));
    target.replaceChildren();
    mount(Playground, { target, props: { module, geometry: paper as unknown as Geometry, theme: bookTheme } });
  } catch (error) {
    target.textContent = `The playground needs WebAssembly and WebGL, and a server of files: ${error instanceof Error ? error.message : String(error)}`;
  }
}
