import { defineConfig } from 'vitest/config';
import { TIMEOUT_MS } from './browser';

// One browser, one server, one test after another: they share a machine that draws in software.
export default defineConfig({
  test: {
    include: ['e2e/**/*.test.ts'],
    fileParallelism: false,
    isolate: false,
    globalSetup: ['e2e/browser.ts'],
    // Each wait within a test has a limit of its own, and its message names the awaited state.
    testTimeout: 0,
    hookTimeout: 0,
    expect: { poll: { timeout: TIMEOUT_MS, interval: 80 } },
    reporters: ['verbose'],
  },
});
