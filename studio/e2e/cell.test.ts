// The work cell: seen, run, broken, mended and kept.

import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import axe from 'axe-core';
import type { Browser, Page } from 'playwright-core';
import { afterAll, afterEach, beforeAll, expect, test } from 'vitest';
import { browse, complaints, ROOT, serve, until, type Server } from './studio';

const PROGRAM = 'HOME\nGET LP1 SLOT 1 WITH A\nPUT ALIGN WITH A\nHOME\n';
const CELL = readFileSync(resolve(ROOT, 'cells/example.toml'), 'utf8');

let browser: Browser;
let server: Server;
let page: Page;
let heard: string[];
let folder: string;

beforeAll(async () => {
  folder = mkdtempSync(join(tmpdir(), 'studio-'));
  writeFileSync(join(folder, 'mine.toml'), CELL);
  writeFileSync(join(folder, 'mine.program'), PROGRAM);
  [browser, server] = await Promise.all([browse(), serve(0, ['--cell', join(folder, 'mine.toml')])]);
  const context = await browser.newContext({ viewport: { width: 1280, height: 720 }, reducedMotion: 'reduce' });
  page = await context.newPage();
  heard = complaints(page);
  await page.goto(server.address);
});
afterAll(async () => {
  await browser?.close();
  await server?.stop();
  rmSync(folder, { recursive: true });
});
afterEach(() => {
  expect(heard.splice(0)).toEqual([]);
});

const verdict = (want: string) => until(`verdict ${want}`, async () => (await page.getByTestId('verdict').getAttribute('data-verdict')) === want);
const now = async () => Number(await page.getByTestId('cell-now').getAttribute('data-time'));

/** Puts other text into an editor, as typing does. */
async function write(kind: 'program' | 'cell', text: string): Promise<void> {
  await page.getByRole('tab', { name: kind === 'program' ? 'Program' : 'Cell file' }).click();
  await page.getByTestId(`text-${kind}`).locator('.cm-content').click();
  await page.keyboard.press('Control+a');
  await page.keyboard.insertText(text);
}

test('the cell is seen, with its parts by name, and its program is safe to run', async () => {
  await verdict('sound');
  await until('the cell is drawn', () => page.evaluate(() => (window.jointplay.measure.cell?.parts().length ?? 0) > 0 && window.jointplay.measure.cellPictures > 0));
  const parts = await page.evaluate(() => window.jointplay.measure.cell!.parts());
  for (const name of ['wall', 'optics', 'blade-A', 'LP1-left']) expect(parts).toContain(name);
});

test('the program runs by the keyboard, by the slider and by its steps', async () => {
  await page.locator('h2').first().click();
  await page.keyboard.press(' ');
  await until('it plays', async () => (await now()) > 0.5);
  await page.keyboard.press(' ');
  const stopped = await now();
  await new Promise((wait) => setTimeout(wait, 200));
  expect(await now()).toBe(stopped);
  await page.getByTestId('cell-time').fill('0');
  expect(await now()).toBe(0);
  await page.getByRole('tab', { name: 'Steps' }).click();
  await page.getByTestId('steps').getByRole('button', { name: /PUT ALIGN/ }).click();
  expect(await now()).toBeGreaterThan(1);
  expect(await page.getByTestId('cell-step').textContent()).toContain('line 3');
  await page.getByTestId('steps').getByRole('button', { name: /lower/ }).first().click();
  expect(await page.getByTestId('cell-step').textContent()).toContain('lower');
  const gantt = (await page.getByTestId('gantt').boundingBox())!;
  await page.getByTestId('gantt').click({ position: { x: gantt.width - 40, y: 60 } });
  expect(await page.getByTestId('cell-step').textContent()).toContain('line 4');
});

test('mistakes are told in the line where they are', async () => {
  await write('program', 'HOME\nGET LP9 SLOT 1 WITH A\n');
  await verdict('refused');
  await page.getByTestId('problems').filter({ hasText: 'line 2, column 5' }).filter({ hasText: 'LP9' }).waitFor();
  await page.getByTestId('text-program').locator('.cm-lintRange-error', { hasText: 'LP9' }).waitFor();
  await write('program', PROGRAM);
  await verdict('sound');
});

test('a wall in the way is a violation: in the list, at its moment, in the line, in the picture', async () => {
  await write('cell', CELL.replace('position_mm = [100.0, -600.0, 500.0]', 'position_mm = [-330.0, 330.0, 500.0]'));
  await verdict('broken');
  const first = page.getByTestId('violations').getByRole('button').first();
  expect(await first.textContent()).toContain('wall');
  await first.click();
  await page.getByTestId('broken-now').filter({ hasText: 'wall' }).waitFor();
  await page.getByTestId('text-program').locator('.cm-lintRange-warning').first().waitFor();
  await page.keyboard.press('Escape');
  await page.getByRole('button', { name: 'Undo' }).click();
  await verdict('sound');
});

test('a station leans too far, is mended, and the file keeps its comments', async () => {
  await page.locator('summary', { hasText: 'LP1' }).click();
  await page.getByTestId('station-LP1-pitch').fill('2');
  await page.getByTestId('station-LP1-pitch').press('Enter');
  await verdict('refused');
  await page.getByTestId('problems').filter({ hasText: 'LP1' }).filter({ hasText: 'leans 2.000°' }).waitFor();
  await page.getByTestId('problems').getByRole('button').first().click();
  await page.getByTestId('text-cell').locator('.cm-lintRange-error').first().waitFor();
  await page.getByRole('button', { name: 'Undo' }).click();
  await verdict('sound');
  await page.getByTestId('station-LP1-x').fill('-494');
  await page.getByTestId('station-LP1-x').press('Enter');
  await until('it can be kept', () => page.getByTestId('save').isEnabled());
  await verdict('sound');
  await page.getByTestId('save').click();
  await until('it is kept', () => page.getByTestId('save').isDisabled());
  const kept = readFileSync(join(folder, 'mine.toml'), 'utf8');
  expect(kept).toContain('-494');
  expect(kept.match(/^\s*#/gm)).toEqual(CELL.match(/^\s*#/gm));
});

test('the robot is beside it', async () => {
  await page.getByRole('button', { name: 'Robot', exact: true }).first().click();
  await until('the robot is drawn', () => page.evaluate(() => window.jointplay.measure.pictures > 0));
  await page.getByRole('button', { name: 'Cell', exact: true }).click();
  await verdict('sound');
});

for (const theme of ['light', 'dark'] as const)
  test(`axe finds nothing, ${theme}`, async () => {
    await page.getByLabel('Theme').selectOption(theme);
    await page.evaluate(axe.source);
    const found = await page.evaluate(async () => {
      const { axe } = window as unknown as { axe: typeof import('axe-core') };
      const { violations } = await axe.run(document, { resultTypes: ['violations'] });
      return violations.map(({ id, nodes }) => `${id}: ${nodes.map(({ html }) => html.slice(0, 160)).join(' | ')}`);
    });
    expect(found).toEqual([]);
  });
