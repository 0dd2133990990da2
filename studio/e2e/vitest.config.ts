import { defineConfig } from 'vitest/config';

// One browser, one server, one test after another: they share a machine that draws in software.
export default defineConfig({
  test: {
    include: ['e2e/**/*.test.ts'],
    fileParallelism: false,
    testTimeout: 60_000,
    hookTimeout: 120_000,
    reporters: ['verbose'],
  },
});
