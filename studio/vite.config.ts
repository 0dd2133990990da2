import { svelte } from '@sveltejs/vite-plugin-svelte';
import { defineConfig } from 'vitest/config';

// `npm run dev` shows the page from source, beside a running `jointplay studio`.
const server = process.env.JOINTPLAY_STUDIO ?? 'http://127.0.0.1:4816';

const proxy = { '/api': { target: server, changeOrigin: true, headers: { origin: server } } };

export default defineConfig({
  base: './',
  plugins: [svelte()],
  build: {
    target: 'es2022',
    // The built page is part of the server's crate; `cargo xtask page` checks that it is what these sources give.
    outDir: '../crates/jointplay-studio/page',
    emptyOutDir: true,
    rolldownOptions: {
      output: {
        // Libraries are files of their own, which stay the same while the page changes.
        codeSplitting: {
          groups: [
            { name: 'three', test: /node_modules\/three\/build/ },
            { name: 'editor', test: /node_modules\/(@codemirror|@lezer|@marijn|style-mod|w3c-keyname|crelt)/ },
          ],
        },
      },
    },
    // No inline script and no data: address, so that the server's content security policy can be strict.
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 1200,
  },
  server: { proxy },
  preview: { proxy },
  test: { include: ['src/**/*.test.ts'] },
});
