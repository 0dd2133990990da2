// The browser that all files of tests share: one start instead of one for each file.

import { existsSync } from 'node:fs';
import { chromium, type LaunchOptions } from 'playwright-core';

const CHROMIUMS = [process.env.CHROMIUM, '/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'];

// Software rendering, and no sandbox, which containers do not support. Without a graphics card, parts of a page are put together faster by the processor itself.
const FLAGS = ['--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist', '--disable-gpu-compositing', '--no-sandbox'];

/** Name of the environment variable with the address of the running browser. */
export const RUNNING = 'JOINTPLAY_TEST_BROWSER';

/** How a browser is started. */
export function options(): LaunchOptions {
  const executablePath = CHROMIUMS.find((path) => path && existsSync(path));
  if (!executablePath) throw new Error('no Chromium found: install it, or name it in CHROMIUM');
  return { executablePath, args: FLAGS };
}

/** Starts the browser before all tests; returns how to end it. */
export default async function setup(): Promise<() => Promise<void>> {
  const server = await chromium.launchServer(options());
  process.env[RUNNING] = server.wsEndpoint();
  return () => server.close();
}
