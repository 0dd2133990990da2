// The start page of the documentation from a plain server of files in a subfolder, and the WebAssembly module in a browser.

import { createServer, type Server } from 'node:http';
import { existsSync, readFileSync } from 'node:fs';
import type { AddressInfo } from 'node:net';
import { extname, join, normalize } from 'node:path';
import type { Browser } from 'playwright-core';
import { afterAll, beforeAll, expect, test } from 'vitest';
import { accessibilityViolations, browse, ROOT, until, visit } from './studio';

const BOOK = join(ROOT, 'target/book');
const MODULE = join(ROOT, 'crates/jointplay-wasm/js');
const TYPES: Record<string, string> = { '.html': 'text/html', '.js': 'text/javascript', '.mjs': 'text/javascript', '.css': 'text/css', '.json': 'application/json', '.svg': 'image/svg+xml' };

let server: Server;
let browser: Browser;
let address: string;

beforeAll(async () => {
  if (!existsSync(join(BOOK, 'introduction.html'))) throw new Error('there is no book: run `cargo xtask book`');
  server = createServer((request, response) => {
    const path = normalize(decodeURIComponent(new URL(request.url ?? '/', 'http://localhost').pathname));
    const [, folder = ''] = path.split('/');
    const root = { docs: BOOK, module: MODULE }[folder];
    const file = root && join(root, path.slice(folder.length + 2) || 'index.html');
    if (!file || !existsSync(file)) {
      response.writeHead(404).end();
      return;
    }
    // Servers that do not know WebAssembly send it as bytes.
    response.writeHead(200, { 'content-type': TYPES[extname(file)] ?? 'application/octet-stream' }).end(readFileSync(file));
  });
  await new Promise<void>((done) => server.listen(0, '127.0.0.1', done));
  address = `http://127.0.0.1:${(server.address() as AddressInfo).port}`;
  browser = await browse();
});

afterAll(async () => {
  await browser?.close();
  server?.close();
});

test('the module computes the numbers of the library in the browser', async () => {
  const page = await visit(browser);
  await page.goto(`${address}/docs/index.html`);
  // A text, since the compiler of the tests would change the imports of a function.
  const found = await page.evaluate<{ differences: string[]; cases: number }>(`(async () => {
    const [jointplay, { check }] = await Promise.all([import('/module/dist/jointplay.js'), import('/module/check.mjs')]);
    const cases = await (await fetch('/module/native.json')).json();
    return { differences: check(jointplay, await jointplay.load(fetch('/module/dist/jointplay.wasm')), cases), cases: cases.length };
  })()`);
  expect(found.differences).toEqual([]);
  expect(found.cases).toBeGreaterThan(150);
  await page.context().close();
});

for (const [theme, width, height] of [['light', 1440, 900], ['navy', 390, 844], ['light', 720, 450], ['light', 512, 350]] as const)
  test(`the robot of the start page moves in the browser, ${theme}, ${width} × ${height}`, async () => {
    const page = await visit(browser, { viewport: { width, height } });
    const external: string[] = [];
    const errors: string[] = [];
    let bytes = 0;
    page.on('request', (request) => request.url().startsWith(address) || external.push(request.url()));
    page.on('response', async (response) => (bytes += (await response.body().catch(() => Buffer.alloc(0))).length));
    page.on('pageerror', (error) => errors.push(error.message));
    await page.addInitScript((theme) => localStorage.setItem('mdbook-theme', theme), theme);
    await page.goto(`${address}/docs/index.html`);
    const drawn = () => page.evaluate(() => Number(document.querySelector<HTMLElement>('.playground .view')?.dataset.drawn ?? 0));
    await until('the robot is drawn', async () => (await drawn()) > 0);
    // As shown, without labels: a canvas may be empty between frames.
    expect((await page.locator('.playground .view').screenshot({ style: '.labels { visibility: hidden }' })).length).toBeGreaterThan(2000);
    const value = (name: string) => page.locator('.playground dl div', { hasText: name }).locator('dd').innerText();
    await expect.poll(() => page.getByLabel('polar').isChecked()).toBe(true);
    const polar = await value('Shift of the centre');
    expect(polar).toMatch(/^\d+\.\d\d µm$/);
    await page.getByLabel('planar').check();
    await until('another model has another shift', async () => (await value('Shift of the centre')) !== polar);
    await page.getByLabel('polar').check();
    await until('the first model has its shift again', async () => (await value('Shift of the centre')) === polar);
    const before = await drawn();
    await page.getByLabel('Tilt angle').fill('0');
    await until('a level platform has no shift', async () => (await value('Shift of the centre')) === '0.00 µm');
    await until('the level platform is drawn', async () => (await drawn()) > before);
    await page.getByLabel('Tilt angle').fill('1.5');
    await until('the platform is tilted to its limit', async () => (await value('Shift of the centre')) !== '0.00 µm');
    await page.getByLabel('Tilt angle').fill('1.2');
    await expect.poll(() => accessibilityViolations(page, '.playground')).toEqual([]);
    expect(external).toEqual([]);
    expect(errors).toEqual([]);
    expect(bytes).toBeLessThan(3e6);
    const [scroll, client] = await page.evaluate(() => [document.documentElement.scrollWidth, document.documentElement.clientWidth]);
    expect(scroll).toBeLessThanOrEqual(client!);
    // The robot and the slider of the tilt are visible at the same time, also at 200 % zoom.
    const [picture, slider] = [(await page.locator('.playground .view').boundingBox())!, (await page.getByLabel('Tilt angle').boundingBox())!];
    expect(Math.max(slider.y + slider.height, picture.y + picture.height) - Math.min(slider.y, picture.y)).toBeLessThanOrEqual(Math.max(height, 400));
    expect(picture.width).toBeGreaterThan(300);
    await page.locator('.playground').scrollIntoViewIfNeeded();
    if (process.env.PICTURES) await page.screenshot({ path: join(process.env.PICTURES, `playground-${theme}-${width}.png`) });
    await page.context().close();
  });

test('the gallery plays recorded motions, and the references are pages of the book', async () => {
  const page = await visit(browser, { viewport: { width: 1440, height: 900 } });
  const external: string[] = [];
  const errors: string[] = [];
  page.on('request', (request) => request.url().startsWith(address) || external.push(request.url()));
  page.on('pageerror', (error) => errors.push(error.message));
  await page.emulateMedia({ reducedMotion: 'reduce' });
  await page.goto(`${address}/docs/reference/gallery.html#four-bar`);
  const drawn = () => page.evaluate(() => Number(document.querySelector<HTMLElement>('.gallery .view')?.dataset.drawn ?? 0));
  // As shown: a canvas may be empty between frames.
  const picture = async () => (await page.locator('.gallery .view').screenshot()).toString('base64');
  const changes = async (what: string, action: () => Promise<unknown>) => {
    const before = await picture();
    await action();
    await until(what, async () => (await picture()) !== before);
  };
  await until('the mechanism is drawn', async () => (await drawn()) > 0);
  const mechanism = page.locator('.gallery select');
  await expect.poll(() => mechanism.inputValue()).toBe('four-bar');
  await expect.poll(() => mechanism.locator('option').count()).toBe(26);
  await expect.poll(() => page.getByLabel('Play the motion').isChecked()).toBe(false);
  await changes('the links have moved', () => page.getByLabel('Position in the motion').fill('0'));
  await changes('another mechanism is drawn', () => mechanism.selectOption('bennett'));
  await changes('the motion plays', () => page.getByLabel('Play the motion').check());
  await page.getByLabel('Play the motion').uncheck();
  await expect.poll(() => accessibilityViolations(page, '.gallery')).toEqual([]);
  if (process.env.PICTURES) await page.screenshot({ path: join(process.env.PICTURES, 'gallery.png') });
  await page.getByRole('link', { name: 'Next chapter' }).first().waitFor();
  // The search of the book, and that of the documentation of the library.
  await page.locator('#mdbook-search-toggle').click();
  await page.locator('#mdbook-searchbar').fill('DriveReques');
  // The search begins when a key is released.
  await page.locator('#mdbook-searchbar').press('t');
  const hits = page.locator('#mdbook-searchresults a[href*="http-types.html"]');
  await until('the search finds a type', async () => (await hits.count()) > 0);
  await page.goto(`${address}/docs/reference/rust.html`);
  await page.getByRole('link', { name: 'jointplay-core' }).click();
  await until('the documentation of the library is open', async () => (await page.title()).includes('jointplay_core'));
  if (process.env.PICTURES) await page.screenshot({ path: join(process.env.PICTURES, 'rust.png') });
  expect(external).toEqual([]);
  expect(errors).toEqual([]);
  await page.context().close();
});

for (const [path, width] of [['index', 1440], ['how-to/run-a-study-on-a-cluster', 390], ['reference/python-types', 1440], ['reference/http-types', 1440], ['how-to/rust', 720]] as const)
  test(`the page ${path} of the book is accessible, and its table of contents opens by keys, at ${width} px`, async () => {
    const page = await visit(browser, { viewport: { width, height: 800 } });
    await page.goto(`${address}/docs/${path}.html`);
    await expect.poll(() => accessibilityViolations(page)).toEqual([]);
    const toggle = page.locator('#mdbook-sidebar-toggle');
    const before = await toggle.getAttribute('aria-expanded');
    for (const key of ['Enter', 'Space']) {
      const is = await toggle.getAttribute('aria-expanded');
      await toggle.focus();
      await page.keyboard.press(key);
      await expect.poll(() => toggle.getAttribute('aria-expanded')).not.toBe(is);
      await expect.poll(() => page.locator('#mdbook-sidebar').getAttribute('aria-hidden')).toBe(is);
    }
    await expect.poll(() => toggle.getAttribute('aria-expanded')).toBe(before);
    await page.context().close();
  });
