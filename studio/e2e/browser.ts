// The browser that all files of tests share: one start instead of one for each file.

import { existsSync } from 'node:fs';
import { chromium, type LaunchOptions } from 'playwright-core';

const CHROMIUMS = [process.env.CHROMIUM, '/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'];

// Suggestions below the address bar are two pages of two hundred scripts each, which every new window loads.
const SUGGESTIONS = ['WebUIOmniboxPopup', 'WebUIOmniboxAimPopup'];

// Those that Playwright disables and that matter here: Chromium takes the last list alone.
const DISABLED_BY_PLAYWRIGHT = ['AimEnabled', 'AvoidUnnecessaryBeforeUnloadCheckSync', 'DestroyProfileOnBrowserClose', 'HttpsFirstBalancedModeAutoEnable', 'HttpsUpgrades', 'MediaRouter', 'NetworkTimeServiceQuerying', 'OptimizationHints', 'PaintHolding', 'PreconnectToSearch', 'ThirdPartyStoragePartitioning'];

// Software rendering, and no sandbox, which containers do not support. Without a graphics card, parts of a page are put together faster by the processor itself.
const FLAGS = ['--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist', '--disable-gpu-compositing', '--no-sandbox', `--disable-features=${[...SUGGESTIONS, ...DISABLED_BY_PLAYWRIGHT].join(',')}`];

/** Name of the environment variable with the address of the running browser. */
export const RUNNING = 'JOINTPLAY_TEST_BROWSER';

/**
 * Timeout of every wait of a test [ms].
 *
 * Tests wait for a state of the page, however long a busy machine takes: expectations of the page are polled. `TIMEOUT_S` shortens the timeout during development.
 */
export const TIMEOUT_MS = Number(process.env.TIMEOUT_S ?? 240) * 1000;

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
