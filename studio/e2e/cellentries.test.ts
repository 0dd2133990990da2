// Stations, bodies and wafers added, duplicated and deleted by button; teaching by clicks; undo of pending changes; the line of the minimum distance.

import { afterAll, afterEach, beforeAll, expect, test } from 'vitest';
import type { Page } from 'playwright-core';
import { EXAMPLE_CELL, accessibilityViolations, cellFixture, complaints, load, partNames, unhandled, until, visit, waitForCheck, type CellFixture } from './studio';

let fixture: CellFixture;
let page: Page;
let heard: string[];

beforeAll(async () => {
  fixture = await cellFixture();
  page = await visit(fixture.browser, { viewport: { width: 1440, height: 900 } });
  heard = complaints(page);
  await load(page, fixture.server.address);
  await waitForCheck(page, 'passed');
  await until('the cell is drawn', async () => (await partNames(page)).length > 0);
});
afterAll(() => fixture?.close());
afterEach(() => {
  expect(unhandled(heard.splice(0))).toEqual([]);
});

/** The text of the cell file in the editor. */
async function cellText(): Promise<string> {
  await page.getByRole('tab', { name: /^Cell file/ }).click();
  const editor = page.getByTestId('text-cell').locator('.cm-content');
  await editor.click();
  await page.keyboard.press('Control+a');
  await page.context().grantPermissions(['clipboard-read', 'clipboard-write']);
  await page.keyboard.press('Control+c');
  const text = await page.evaluate(() => navigator.clipboard.readText());
  await page.getByRole('tab', { name: 'Parts' }).click();
  return text;
}
const part = (name: string) => page.getByTestId('parts').getByRole('button', { name: new RegExp(`^${name}( |$)`) });
/** Selects a part that may be selected already. */
const choose = async (name: string) => {
  if ((await part(name).getAttribute('aria-pressed')) !== 'true') await part(name).click();
};
const openList = async (name: string) => {
  const list = page.getByTestId('parts').locator('details').filter({ has: page.locator('summary', { hasText: name }) }).last();
  if ((await list.getAttribute('open')) === null) await list.locator('summary').first().click();
};
const undo = () => page.locator('.files').getByRole('button', { name: 'Undo' }).click();
const comments = (text: string) => text.split('\n').filter((line) => line.trim().startsWith('#'));

test('a station is duplicated with its bodies, and deleted again; comments remain', async () => {
  await page.getByRole('tab', { name: 'Parts' }).click();
  await choose('LP1');
  await page.getByTestId('part-duplicate').click();
  await part('LP3').waitFor();
  await until('LP3 is selected', async () => (await part('LP3').getAttribute('aria-pressed')) === 'true');
  await until('its bodies are drawn', async () => (await partNames(page)).includes('LP3-left'));
  const text = await cellText();
  expect(comments(text)).toEqual(comments(EXAMPLE_CELL));
  await page.getByTestId('part-delete').click();
  await until('LP3 is deleted', async () => (await part('LP3').count()) === 0);
  await expect.poll(() => cellText()).toBe(EXAMPLE_CELL);
  await undo();
  await part('LP3').waitFor();
  await undo();
  await until('LP3 is deleted again', async () => (await part('LP3').count()) === 0);
  await waitForCheck(page, 'passed');
});

test('stations and bodies are added where robot and camera are', async () => {
  await page.getByTestId('add-station').click();
  await part('S1').waitFor();
  await openList('Bodies');
  await page.getByTestId('add-body').click();
  await part('body-1').waitFor();
  await until('it is drawn', async () => (await partNames(page)).includes('body-1'));
  await expect.poll(() => accessibilityViolations(page)).toEqual([]);
  await undo();
  await undo();
  await until('both are removed', async () => (await part('S1').count()) === 0 && (await part('body-1').count()) === 0);
  await waitForCheck(page, 'passed');
});

test('wafers of a station are typed as ranges; what is no slot is refused', async () => {
  await choose('LP2');
  const field = page.getByTestId('station-LP2-wafers');
  await field.fill('2-4, 7');
  await field.press('Enter');
  const wafers = async () => (await partNames(page)).filter((name) => name.startsWith('wafer of LP2')).length;
  await until('four wafers', async () => (await wafers()) === 4);
  await until('they are listed', async () => (await field.inputValue()) === '2-4, 7');
  await field.fill('26');
  await field.press('Enter');
  await page.getByRole('alert').filter({ hasText: 'from 1 to 25' }).waitFor();
  await page.getByTestId('station-LP2-wafers-all').click();
  await until('25 wafers', async () => (await wafers()) === 25);
  await undo();
  await undo();
  await until('no wafers', async () => (await wafers()) === 0);
});

test('undo cancels a pending change and not the step before', async () => {
  await waitForCheck(page, 'passed');
  const before = await cellText();
  await choose('LP2');
  await page.getByTestId('station-LP2-wafers-all').click();
  await until('the wafers are there', async () => (await partNames(page)).includes('wafer of LP2 1'));
  await page.route('**/api/v1/cell/entry', () => undefined);
  await page.getByTestId('part-duplicate').click();
  await until('the check is outdated', async () => (await page.getByTestId('check-result').getAttribute('data-state')) === 'outdated');
  await undo();
  await waitForCheck(page, 'passed');
  await expect.poll(() => cellText()).toContain('wafers = "all"');
  await expect.poll(async () => (await cellText()).match(/wafers = "all"/g)!.length).toBe(before.match(/wafers = "all"/g)!.length + 1);
  await page.unroute('**/api/v1/cell/entry');
  await undo();
  await until('the step before is undone', async () => !(await partNames(page)).includes('wafer of LP2 1'));
});

test('a station is taught by clicked points of bodies', async () => {
  await waitForCheck(page, 'passed');
  await page.getByRole('button', { name: 'Top', exact: true }).click();
  await choose('ALIGN');
  await page.getByTestId('teach-ALIGN-click').click();
  const box = (await page.locator('.scene canvas').first().boundingBox())!;
  const points = async () => page.getByTestId('points-ALIGN').locator('li').count();
  for (let k = 0; k < 300 && (await points()) < 2; k += 1) await page.mouse.click(box.x + (0.3 + 0.4 * ((k * 0.618034) % 1)) * box.width, box.y + (0.3 + 0.4 * ((k + 0.5) / 300)) * box.height);
  await expect.poll(() => points()).toBe(2);
  await page.getByTestId('plane-ALIGN').filter({ hasText: '2 of 3 points' }).waitFor();
  await page.keyboard.press('Escape');
  await until('clicks select again', async () => (await page.getByTestId('teach-ALIGN-click').getAttribute('aria-pressed')) === 'false');
  await undo();
  await until('one point is left', async () => (await points()) === 1);
  await undo();
});

test('the minimum distance is a line between the nearest points, of the nearest or of a chosen pair', async () => {
  const line = () => page.evaluate(() => window.jointplay.probe.cell!.nearest());
  type Distances = { distance_m: number; nearest_points_m: number[][] }[];
  const asked = await fetch(`${fixture.server.address}api/v1/cell/jog`, { method: 'POST', headers: { 'content-type': 'application/json' }, body: JSON.stringify({ time_s: 0 }) });
  const { distances } = ((await asked.json()) as { check: { distances: Distances } }).check;
  await page.getByTestId('cell-time').fill('0');
  const isLine = (found: number[], pair: Distances[number]) => found.length === 6 && pair.nearest_points_m.flat().every((value, k) => Math.abs(value - found[k]!) < 1e-6);
  await until('the line of the nearest pair', async () => isLine(await line(), distances[0]!));
  const rows = page.getByTestId('jog-distances').getByRole('button');
  await rows.nth(1).click();
  await until('the line of the second pair', async () => isLine(await line(), distances[1]!));
  await page.getByTestId('nearest-toggle').click();
  await until('no line', async () => (await line()).length === 0);
  await page.getByTestId('nearest-toggle').click();
  await page.getByTestId('cell-play-scale').fill('500');
  await until('no line with enlarged play', async () => (await line()).length === 0);
  await page.getByTestId('cell-play-scale').fill('0');
  await until('the line again', async () => (await line()).length === 6);
});
