import { svelte } from '@sveltejs/vite-plugin-svelte';
import { defineConfig } from 'vite';

// The playground and the gallery of the documentation: scripts and the WebAssembly module, for any folder of any server of files.
export default defineConfig({
  base: './',
  publicDir: false,
  // Scripts with their styles: a page that links one needs nothing else.
  plugins: [svelte({ compilerOptions: { css: 'injected' } })],
  build: {
    target: 'es2022',
    // A part of the book; `cargo xtask page` checks that it matches the sources.
    outDir: '../docs/playground',
    emptyOutDir: true,
    rolldownOptions: {
      input: { playground: 'src/playground/main.ts', gallery: 'src/gallery/main.ts' },
      output: { entryFileNames: '[name].js', chunkFileNames: 'scene.js', assetFileNames: '[name][extname]' },
    },
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 1200,
  },
});
