// Set-up of the browser tests: `jointplay studio`, a browser, and waiting for a state of the page.

import { spawn, type ChildProcess } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import axe from 'axe-core';
import { chromium, type Browser, type BrowserContextOptions, type Download, type Page } from 'playwright-core';
import { options, RUNNING, TIMEOUT_MS } from './browser';

export const ROOT = resolve(import.meta.dirname, '../..');
export const COMMAND = process.env.JOINTPLAY_COMMAND ?? resolve(ROOT, 'target/debug/jointplay');

export interface Server {
  address: string;
  port: number;
  process: ChildProcess;
  /** Standard output until the address of the page. */
  output: string;
  stop(): Promise<void>;
}

export const serve = (port = 0, more: string[] = []): Promise<Server> => start(['studio', '--no-open', '--port', String(port), ...more]);

/** A command that serves the page. */
export async function start(args: string[]): Promise<Server> {
  const process = spawn(COMMAND, args, { stdio: ['ignore', 'pipe', 'inherit'] });
  let output = '';
  const address = await new Promise<string>((found, failed) => {
    process.stdout.on('data', (text: Buffer) => {
      output += text.toString();
      const match = /http:\/\/127\.0\.0\.1:\d+\//.exec(output);
      if (match) found(match[0]);
    });
    process.on('error', failed);
    process.on('exit', (code) => failed(new Error(`${COMMAND} ${args.join(' ')} ended with ${code}: ${output}`)));
  });
  return {
    address,
    port: Number(new URL(address).port),
    process,
    output,
    stop: () =>
      new Promise((done) => {
        if (process.exitCode !== null) return done();
        process.on('exit', () => done());
        process.kill('SIGINT');
      }),
  };
}

/** The browser of this run, see `browser.ts`, or one of its own; closing it leaves that of the run open. */
export async function browse(): Promise<Browser> {
  const running = process.env[RUNNING];
  return running ? chromium.connect(running, { timeout: TIMEOUT_MS }) : chromium.launch(options());
}

/** Device pixels in a pixel of the page: software rendering takes time for each of them, and tests look at few. */
const SCALE = 0.5;

/** Longest delay of an answer to the page [ms], for half of them: a slow network, which a test must not depend on. */
const DELAY_MS = Number(process.env.DELAY_S ?? 0) * 1000;

/** A new page in a browser context of its own. */
export async function visit(browser: Browser, more: BrowserContextOptions = {}): Promise<Page> {
  const context = await browser.newContext({ viewport: { width: 1280, height: 720 }, reducedMotion: 'reduce', acceptDownloads: true, deviceScaleFactor: SCALE, ...more });
  context.setDefaultTimeout(TIMEOUT_MS);
  if (DELAY_MS > 0)
    await context.route('**', async (route) => {
      if (Math.random() < 0.5) await new Promise((wait) => setTimeout(wait, Math.random() * DELAY_MS));
      // The page may be closed by now.
      await route.fallback().catch(() => {});
    });
  return context.newPage();
}

/** Opens the page, and waits until its scripts have run: the browser reports it as loaded before. */
export async function load(page: Page, address: string): Promise<void> {
  await page.goto(address);
  await scripts(page);
}

/** Loads the page again, and waits until its scripts have run. */
export async function reload(page: Page): Promise<void> {
  await page.reload();
  await scripts(page);
}

const scripts = (page: Page) => until('the scripts of the page have run', () => page.evaluate(() => 'jointplay' in window));

/** The bytes of a download: the browser may run elsewhere, so that its files have no path here. */
export async function bytesOf(download: Download): Promise<Buffer> {
  const parts: Buffer[] = [];
  for await (const part of await download.createReadStream()) parts.push(part as Buffer);
  return Buffer.concat(parts);
}

/** Waits for a number of animation frames. */
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

/** Collects errors and warnings of the console. */
export function complaints(page: Page): string[] {
  const heard: string[] = [];
  page.on('console', (message) => {
    if (['error', 'warning'].includes(message.type()) && !/GPU stall due to ReadPixels/.test(message.text()))
      heard.push(`${message.type()}: ${message.text()}`);
  });
  page.on('pageerror', (error) => heard.push(`error: ${error.message}`));
  return heard;
}

/** Complaints but for those of responses that the page handles: 409 of an outdated request, and 404 of a plan that a newer one has replaced. */
export const unhandled = (heard: string[]): string[] => heard.filter((line) => !/status of 40[49]\b/.test(line));

/** Waits until the page has rendered a pose that satisfies a condition: a JavaScript expression in `pose`. */
export async function drawn(page: Page, holds = 'true'): Promise<void> {
  const asked = `(() => { const pose = window.jointplay?.probe?.pose; return Boolean(pose && (${holds})); })()`;
  await until(holds, () => page.evaluate(asked) as Promise<boolean>);
}

/** Polls a condition from outside the page: its security policy forbids evaluating strings in it. */
export async function until(what: string, asked: () => Promise<boolean>): Promise<void> {
  const end = Date.now() + TIMEOUT_MS;
  while (!(await asked())) {
    if (Date.now() > end) throw new Error(`timeout while waiting for: ${what}`);
    await new Promise((wait) => setTimeout(wait, 80));
  }
}

/** The example cell, and a short program in it. */
export const EXAMPLE_CELL = readFileSync(resolve(ROOT, 'crates/jointplay-format/cells/example.toml'), 'utf8');
export const SHORT_PROGRAM = 'HOME\nGET LP1 SLOT 1 WITH A\nPUT ALIGN WITH A\nHOME\n';

/** A server of a cell in a temporary folder, and a browser. */
export interface CellFixture {
  browser: Browser;
  server: Server;
  folder: string;
  cellFile: string;
  programFile: string;
  close(): Promise<void>;
}

export async function cellFixture(program = SHORT_PROGRAM, cell = EXAMPLE_CELL): Promise<CellFixture> {
  const folder = mkdtempSync(join(tmpdir(), 'studio-'));
  const cellFile = join(folder, 'mine.toml');
  const programFile = join(folder, 'mine.program');
  writeFileSync(cellFile, cell);
  writeFileSync(programFile, program);
  const [browser, server] = await Promise.all([browse(), serve(0, ['--cell', cellFile])]);
  const fixture: CellFixture = {
    browser,
    server,
    folder,
    cellFile,
    programFile,
    async close() {
      await browser.close();
      await fixture.server.stop();
      rmSync(folder, { recursive: true });
    },
  };
  return fixture;
}

/** The state of the check result on the page. */
export const checkState = (page: Page) => page.getByTestId('check-result').getAttribute('data-state');

/** Waits for a state of the check result. */
export const waitForCheck = (page: Page, state: string) => until(`check result ${state}`, async () => (await checkState(page)) === state);

/** Positions of the joints of the mechanism, once the view has any [m]. */
export async function joints(page: Page): Promise<Record<string, number[]>> {
  await page.waitForFunction(() => Object.keys(window.jointplay.probe.mechanism?.joints() ?? {}).length > 0, undefined, { polling: 100 });
  return page.evaluate(() => window.jointplay.probe.mechanism!.joints());
}

/** Names of all parts in the 3D view of the cell. */
export const partNames = (page: Page) => page.evaluate(() => window.jointplay.probe.cell?.parts() ?? []);

/** Violations of accessibility rules found by axe, in the page or in a part of it. */
export async function accessibilityViolations(page: Page, part = 'html'): Promise<string[]> {
  await page.evaluate(axe.source);
  return page.evaluate(async (part) => {
    const { axe } = window as unknown as { axe: typeof import('axe-core') };
    const { violations } = await axe.run(part, { resultTypes: ['violations'], rules: { 'target-size': { enabled: true } } });
    return violations.map(({ id, nodes }) => `${id}: ${nodes.map(({ html }) => html.slice(0, 160)).join(' | ')}`);
  }, part);
}
