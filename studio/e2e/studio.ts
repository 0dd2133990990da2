// Starts `jointplay studio`, and a browser in front of it.

import { spawn, type ChildProcess } from 'node:child_process';
import { existsSync } from 'node:fs';
import { resolve } from 'node:path';
import { chromium, type Browser, type BrowserContextOptions, type Page } from 'playwright-core';

/**
 * How long anything may take before a test gives up [ms].
 *
 * Tests wait for what the page shows, however long a busy machine takes; only what would never come ends here.
 * While you write, `PATIENCE_S` makes it shorter.
 */
export const PATIENCE_MS = Number(process.env.PATIENCE_S ?? 900) * 1000;

export const ROOT = resolve(import.meta.dirname, '../..');
export const COMMAND = process.env.JOINTPLAY_COMMAND ?? resolve(ROOT, 'target/debug/jointplay');

const CHROMIUMS = [process.env.CHROMIUM, '/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'];
// Drawing without a graphics card, and without Chromium's own sandbox, which containers do not allow.
const FLAGS = [
  '--use-gl=angle',
  '--use-angle=swiftshader',
  '--enable-unsafe-swiftshader',
  '--ignore-gpu-blocklist',
  '--no-sandbox',
];

export interface Server {
  address: string;
  port: number;
  process: ChildProcess;
  stop(): Promise<void>;
}

export async function serve(port = 0, more: string[] = []): Promise<Server> {
  const process = spawn(COMMAND, ['studio', '--no-open', '--port', String(port), ...more], {
    stdio: ['ignore', 'pipe', 'inherit'],
  });
  const address = await new Promise<string>((found, failed) => {
    let said = '';
    process.stdout.on('data', (text: Buffer) => {
      said += text.toString();
      const match = /http:\/\/127\.0\.0\.1:\d+\//.exec(said);
      if (match) found(match[0]);
    });
    process.on('error', failed);
    process.on('exit', (code) => failed(new Error(`${COMMAND} studio ended with ${code}: ${said}`)));
  });
  return {
    address,
    port: Number(new URL(address).port),
    process,
    stop: () =>
      new Promise((done) => {
        if (process.exitCode !== null) return done();
        process.on('exit', () => done());
        process.kill('SIGINT');
      }),
  };
}

export async function browse(): Promise<Browser> {
  const executablePath = CHROMIUMS.find((path) => path && existsSync(path));
  if (!executablePath) throw new Error('no Chromium found: install it, or name it in CHROMIUM');
  return chromium.launch({ executablePath, args: FLAGS, timeout: PATIENCE_MS });
}

/** A page of its own in the browser. */
export async function visit(browser: Browser, more: BrowserContextOptions = {}): Promise<Page> {
  const context = await browser.newContext({ viewport: { width: 1280, height: 720 }, reducedMotion: 'reduce', acceptDownloads: true, ...more });
  context.setDefaultTimeout(PATIENCE_MS);
  return context.newPage();
}

/** Waits until the page has painted a few more frames: time enough for what moves to be seen moving. */
export async function frames(page: Page, count = 6): Promise<void> {
  await page.evaluate(
    (left) =>
      new Promise<void>((done) => {
        const next = () => (left-- > 0 ? requestAnimationFrame(next) : done());
        next();
      }),
    count,
  );
}

/** What the page complained about, which should be nothing. */
export function complaints(page: Page): string[] {
  const heard: string[] = [];
  page.on('console', (message) => {
    if (['error', 'warning'].includes(message.type()) && !/GPU stall due to ReadPixels/.test(message.text()))
      heard.push(`${message.type()}: ${message.text()}`);
  });
  page.on('pageerror', (error) => heard.push(`error: ${error.message}`));
  return heard;
}

/** Waits until the page has drawn a pose for which something holds, said in JavaScript about `pose`. */
export async function drawn(page: Page, holds = 'true'): Promise<void> {
  const asked = `(() => { const pose = window.jointplay?.probe?.pose; return Boolean(pose && (${holds})); })()`;
  await until(holds, () => page.evaluate(asked) as Promise<boolean>);
}

/** Asks again and again: the page's security policy forbids that the question itself stays in it. */
export async function until(what: string, asked: () => Promise<boolean>): Promise<void> {
  const end = Date.now() + PATIENCE_MS;
  while (!(await asked())) {
    if (Date.now() > end) throw new Error(`waited in vain for: ${what}`);
    await new Promise((wait) => setTimeout(wait, 25));
  }
}
