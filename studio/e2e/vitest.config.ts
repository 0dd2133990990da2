import { defineConfig } from 'vitest/config';
import { TIMEOUT_MS } from './browser';

// One browser for all files, two of which are tested at a time: a page waits for its server, and a server for its page.
export default defineConfig({
  test: {
    include: ['e2e/**/*.test.ts'],
    maxWorkers: 2,
    isolate: false,
    globalSetup: ['e2e/browser.ts'],
    // Each wait within a test has a limit of its own, and its message names the awaited state.
    testTimeout: 0,
    hookTimeout: 0,
    expect: { poll: { timeout: TIMEOUT_MS, interval: 80 } },
    reporters: ['verbose'],
  },
});
