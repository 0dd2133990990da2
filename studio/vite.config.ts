import { svelte } from '@sveltejs/vite-plugin-svelte';
import type { Plugin } from 'vite';
import { defineConfig } from 'vitest/config';

// `npm run dev` serves the page from source; its requests go to a running `jointplay studio`.
const server = process.env.JOINTPLAY_STUDIO ?? 'http://127.0.0.1:4816';

/** uPlot's own creation of its canvas context, and the replacement. */
const UPLOT_CONTEXT = ['can.getContext("2d")', 'can.getContext("2d", { willReadFrequently: true })'] as const;

/**
 * Makes uPlot draw on the CPU: without a graphics card, browsers take seconds for long lines on an accelerated canvas.
 * uPlot has no option for the attributes of its context.
 */
const uplotOnCpu: Plugin = {
  name: 'uplot-on-cpu',
  transform(code, id) {
    if (!/node_modules\/uplot\/dist\/uPlot\.esm\.js/.test(id)) return null;
    const [original, replacement] = UPLOT_CONTEXT;
    if (!code.includes(original)) throw new Error(`uPlot no longer creates its context by ${original}`);
    return { code: code.replace(original, replacement), map: null };
  },
};

const proxy = { '/api': { target: server, changeOrigin: true, headers: { origin: server } } };

export default defineConfig({
  base: './',
  plugins: [svelte(), uplotOnCpu],
  // Pre-bundled packages do not pass through plugins.
  optimizeDeps: { exclude: ['uplot'] },
  build: {
    target: 'es2022',
    // The built page is part of the server's crate; `cargo xtask page` checks that it matches the sources.
    outDir: '../crates/jointplay-studio/page',
    emptyOutDir: true,
    rolldownOptions: {
      output: {
        // Libraries are separate files, so that changes of the page do not change them.
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
