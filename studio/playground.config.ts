import { svelte } from '@sveltejs/vite-plugin-svelte';
import { defineConfig } from 'vite';

// The playground of the documentation: scripts and the WebAssembly module, for any folder of any server of files.
export default defineConfig({
  base: './',
  publicDir: false,
  // One script with its styles: a page that links it needs nothing else.
  plugins: [svelte({ compilerOptions: { css: 'injected' } })],
  build: {
    target: 'es2022',
    // A part of the book; `cargo xtask page` checks that it matches the sources.
    outDir: '../docs/playground',
    emptyOutDir: true,
    rolldownOptions: {
      input: 'src/playground/main.ts',
      output: { entryFileNames: 'playground.js', chunkFileNames: '[name].js', assetFileNames: '[name][extname]' },
    },
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 1200,
  },
});
