// Printed pages: the picture of the view and the panels with results, without toolbars and controls.

import type { Browser, Page } from 'playwright-core';
import { afterAll, beforeAll, expect, test } from 'vitest';
import { browse, complaints, drawn, load, serve, unhandled, until, visit, type Server } from './studio';

let browser: Browser;
let server: Server;

beforeAll(async () => {
  [browser, server] = await Promise.all([browse(), serve(0, ['--cell', 'example'])]);
});
afterAll(async () => {
  await browser?.close();
  await server?.stop();
});

/** How many colors a sample of the printed picture has, and the color in its corner. */
const picture = (page: Page) =>
  page.evaluate(() => {
    const canvas = document.querySelector<HTMLCanvasElement>('.printed canvas')!;
    // A copy: browsers complain about canvases that are read repeatedly without this option.
    const copy = Object.assign(document.createElement('canvas'), { width: canvas.width, height: canvas.height });
    const context = copy.getContext('2d', { willReadFrequently: true })!;
    context.drawImage(canvas, 0, 0);
    const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
    const colors = new Set<string>();
    for (let i = 0; i < data.length; i += 4 * 997) colors.add(data.slice(i, i + 3).join());
    return { colors: colors.size, corner: [...data.slice(0, 3)], width: canvas.getBoundingClientRect().width };
  });

const VIEWS = [
  { name: 'Robot', ready: (page: Page) => drawn(page), shown: ['Pose', 'Virtualization', 'Mobility'], text: 'Centre shift' },
  { name: 'Mechanism', ready: (page: Page) => until('the mechanism', async () => (await page.getByTestId('m-finite').count()) === 1), shown: ['Mobility'], text: 'Finite' },
  { name: 'Cell', ready: (page: Page) => until('the check', async () => (await page.getByTestId('check-result').getAttribute('data-state')) === 'passed'), shown: ['Check result'], text: 'No violations' },
] as const;

for (const { name, ready, shown, text } of VIEWS)
  test(`a printed page has picture and results, without toolbars: ${name}`, async () => {
    const page = await visit(browser, { viewport: { width: 1440, height: 900 }, colorScheme: 'dark' });
    const heard = complaints(page);
    await load(page, server.address);
    await page.getByRole('button', { name, exact: true }).click();
    if (name === 'Mechanism') await page.getByTestId('entry-four-bar').click();
    await ready(page);
    const atOnce = await page.evaluate(() => {
      window.dispatchEvent(new Event('beforeprint'));
      const found = { hidden: document.querySelector<HTMLCanvasElement>('.printed canvas')!.hidden, title: document.querySelector('.printed b')!.textContent };
      window.dispatchEvent(new Event('afterprint'));
      return found;
    });
    if (name !== 'Cell') expect(atOnce).toEqual({ hidden: false, title: expect.stringMatching(/./) });
    await page.emulateMedia({ media: 'print' });
    // The canvas keeps the picture of before until the page is laid out for paper.
    let printed = await picture(page);
    await until('the printed picture', async () => (printed = await picture(page)).colors > 20 && printed.width > 0);
    const { corner, width } = printed;
    // Light, as paper, although the page is dark.
    expect(Math.min(...corner)).toBeGreaterThan(200);
    expect(width).toBeGreaterThan(600);
    for (const title of shown) await expect.poll(() => page.locator('aside[data-dock] h2', { hasText: title }).first().isVisible(), { message: title }).toBe(true);
    await expect.poll(() => page.locator('aside[data-dock]').getByText(text).first().isVisible()).toBe(true);
    const controls = await page.locator('header, nav, input[type=range], [role=tab], .views, .timeline, .grip').evaluateAll((all) => all.filter((one) => (one as HTMLElement).offsetParent !== null).map(({ className }) => className));
    expect(controls).toEqual([]);
    const pdf = await page.pdf({ format: 'A4' });
    const pages = pdf.toString('latin1').match(/\/Type \/Page\b/g)?.length ?? 0;
    expect(pages).toBeGreaterThanOrEqual(1);
    expect(pages).toBeLessThanOrEqual(3);
    await page.emulateMedia({ media: 'screen' });
    await until('the page is dark again', () => page.evaluate(() => document.documentElement.dataset.theme === 'dark'));
    expect(unhandled(heard)).toEqual([]);
    await page.context().close();
  });

test('a page printed before its view is loaded has the picture once the view is', async () => {
  const page = await visit(browser, { viewport: { width: 1440, height: 900 } });
  const heard = complaints(page);
  let release = () => {};
  const held = new Promise<void>((done) => (release = done));
  await page.route('**/cell/scenes/*', async (route) => {
    await held;
    await route.continue();
  });
  await load(page, server.address);
  await page.getByRole('button', { name: 'Cell', exact: true }).click();
  await until('the check', async () => (await page.getByTestId('check-result').getAttribute('data-state')) === 'passed');
  await page.emulateMedia({ media: 'print' });
  await expect.poll(() => page.getByText('The view was not loaded yet.').isVisible()).toBe(true);
  await expect.poll(() => page.locator('.printed canvas').isVisible()).toBe(false);
  release();
  await until('the printed picture', async () => (await picture(page)).colors > 20);
  await expect.poll(() => page.getByText('The view was not loaded yet.').count()).toBe(0);
  expect(unhandled(heard)).toEqual([]);
  await page.context().close();
});
