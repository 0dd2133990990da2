// The cell view: export, links, play of the platform, tools of the view, grouped violations, chart.

import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import type { Page } from 'playwright-core';
import { afterAll, afterEach, beforeAll, expect, test } from 'vitest';
import { COMMAND, EXAMPLE_CELL, accessibilityViolations, bytesOf, cellFixture, complaints, load, partNames, unhandled, until, visit, waitForCheck, type CellFixture } from './studio';

// LP2 is tilted: there the platform has play.
const PROGRAM = 'HOME\nGET LP2 SLOT 1 WITH A\nPUT ALIGN WITH A\nHOME\n';
const CELL = EXAMPLE_CELL.replace('name = "LP2"', 'name = "LP2"\nwafers = "all"');

let fixture: CellFixture;
let page: Page;
let heard: string[];

beforeAll(async () => {
  fixture = await cellFixture(PROGRAM, CELL);
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

const now = async () => Number(await page.getByTestId('cell-now').getAttribute('data-time'));
const origin = (name: string) => page.evaluate((of) => window.jointplay.probe.cell!.origin(of)!, name);
const shown = () => page.evaluate(() => window.jointplay.probe.cell!.shown());
const camera = () => page.evaluate(() => window.jointplay.probe.cell!.camera()!);

/** The file that an entry of the menu exports. */
async function exported(entry: string): Promise<{ name: string; bytes: Buffer }> {
  await page.getByTestId('cell-export').click();
  const awaited = page.waitForEvent('download');
  await page.getByTestId(`cell-export-${entry}`).click();
  const download = await awaited;
  return { name: download.suggestedFilename(), bytes: await bytesOf(download) };
}

/** A file that the command writes for the same cell and program. */
function written(name: string, ...options: string[]): string {
  const out = join(fixture.folder, 'out');
  execFileSync(COMMAND, ['cell', 'export', fixture.cellFile, fixture.programFile, '--out', out, '--force', ...options]);
  return readFileSync(join(out, name), 'utf8');
}

/** Selects a part in the list. */
async function choose(group: string | null, name: string): Promise<void> {
  await page.getByRole('tab', { name: 'Parts' }).click();
  const part = page.getByTestId('parts').getByRole('button', { name: new RegExp(`^${name}( |$)`) });
  if (group !== null && !(await part.isVisible())) await page.getByTestId('parts').getByText(group).click();
  if ((await part.getAttribute('aria-pressed')) !== 'true') await part.click();
  await until(`${name} is selected`, async () => (await part.getAttribute('aria-pressed')) === 'true');
}

test('exported files are those of the command', async () => {
  const csv = await exported('csv');
  expect(csv.name).toBe('mine.csv');
  expect(csv.bytes.toString()).toBe(written('mine.csv', '--to', 'csv'));
  for (const [dialect, ending] of [['neutral', 'txt'], ['points', 'pvt']]) {
    const text = await exported(`text-${dialect}`);
    expect(text.bytes.toString()).toBe(written(text.name, '--to', 'text', '--dialect', dialect!));
    expect(text.name).toBe(`mine-${dialect}.${ending}`);
  }
  const report = await exported('report');
  const own = join(fixture.folder, 'own.html');
  execFileSync(COMMAND, ['cell', 'report', fixture.cellFile, fixture.programFile, '--out', own]);
  expect([report.name, report.bytes.toString()]).toEqual(['mine-report.html', readFileSync(own, 'utf8')]);
  const scene = await exported('gltf');
  expect([scene.name, scene.bytes.subarray(0, 4).toString()]).toEqual(['mine.glb', 'glTF']);
});

test('the view is exported as a picture, and a time range as a film', async () => {
  const picture = await exported('view');
  expect([picture.name, picture.bytes.subarray(1, 4).toString()]).toEqual(['mine.png', 'PNG']);
  await page.getByTestId('gantt').hover();
  for (let k = 0; k < 12; k += 1) await page.mouse.wheel(0, -200);
  await page.getByRole('button', { name: 'Fit time' }).waitFor();
  await page.getByLabel('Playback speed').selectOption('10');
  const film = await exported('video');
  expect(film.name).toMatch(/^mine\.(mp4|webm)$/);
  expect(film.bytes.length).toBeGreaterThan(1000);
  await page.getByLabel('Playback speed').selectOption('1');
  await page.getByRole('button', { name: 'Fit time' }).click();
});

test('a link opens the same time, selection, play scale and camera', async () => {
  await choose(null, 'PM1');
  await page.getByRole('button', { name: 'Top', exact: true }).click();
  await page.getByRole('tab', { name: 'Steps' }).click();
  await page.getByTestId('steps').getByRole('button', { name: /PUT ALIGN/ }).click();
  await page.getByTestId('cell-play-scale').fill('700');
  await page.getByTestId('cell-link').click();
  const link = await page.evaluate(() => window.location.href);
  const [time, seen] = [await now(), await camera()];
  const other = await visit(fixture.browser, { viewport: { width: 1440, height: 900 } });
  try {
    await load(other, link);
    await waitForCheck(other, 'passed');
    await until('it is at that time', async () => Math.abs(Number(await other.getByTestId('cell-now').getAttribute('data-time')) - time) < 1e-5);
    await until('the cell is drawn', async () => (await partNames(other)).length > 0);
    await until('the camera is there', async () => {
      const found = await other.evaluate(() => window.jointplay.probe.cell!.camera()!);
      return [...found.eye, ...found.target].every((value, k) => Math.abs(value - [...seen.eye, ...seen.target][k]!) < 1e-4);
    });
    await expect.poll(() => other.getByRole('tab', { name: 'Steps' }).getAttribute('aria-selected')).toBe('true');
    await other.getByTestId('steps').getByRole('button', { expanded: true, name: /PUT ALIGN/ }).waitFor();
    await until('PM1 is selected', async () => (await other.evaluate(() => window.jointplay.probe.cell!.selected())).length > 0);
    await expect.poll(() => other.getByTestId('play-scale-note').textContent()).toBe(await page.getByTestId('play-scale-note').textContent());
  } finally {
    await other.context().close();
  }
  await page.getByTestId('cell-play-scale').fill('0');
});

test('the play of the platform is shown at each time, enlarged in the picture only', async () => {
  await page.getByRole('tab', { name: 'Steps' }).click();
  await page.getByTestId('steps').getByRole('button', { name: /GET LP2/ }).click();
  await page.getByTestId('steps').getByRole('button', { name: /retract/ }).first().click();
  await until('the models are there', async () => (await page.getByTestId('cell-play-models').locator('tbody tr').count()) === 4);
  const time = await now();
  const answer = await fetch(`${fixture.server.address}api/v1/cell/jog`, { method: 'POST', headers: { 'content-type': 'application/json' }, body: JSON.stringify({ time_s: time }) });
  const { play } = (await answer.json()) as { play: { virtualization: string; budget_m: number; models: { model: { virtualization: string }; answer: { displacement_m: number; center_shift_m: number[] } }[] } };
  const own = play.models.find(({ model }) => model.virtualization === play.virtualization)!.answer;
  expect(own.displacement_m, 'the platform is tilted at LP2').toBeGreaterThan(1e-6);
  await until('the displacement is that of the server', async () => Math.abs(Number(await page.getByTestId('cell-play-budget').getAttribute('data-value')) - own.displacement_m) < 2e-8);
  await expect.poll(() => page.getByTestId('cell-play-budget').textContent()).toContain(`${((100 * own.displacement_m) / play.budget_m).toFixed(0)} % of the budget`);
  const before = await origin('platform');
  for (const k of [0, 1]) expect(before[k]).toBeCloseTo(own.center_shift_m[k]!, 6);
  await page.getByTestId('cell-play-scale').fill('1000');
  await page.getByTestId('play-scale-note').filter({ hasText: '2000×' }).waitFor();
  await until('the platform is displaced 2000 times as far', async () => (await origin('platform')).slice(0, 2).every((value, k) => Math.abs(value - 2000 * own.center_shift_m[k]!) < 2e-4));
  await waitForCheck(page, 'passed');
  await page.getByTestId('cell-plots-toggle').click();
  await page.getByTestId('plot-play').locator('canvas').waitFor();
  // Tilt and friction as shares of their limits, which the passed program keeps.
  const budgets = page.getByTestId('plot-budgets');
  await budgets.locator('canvas').waitFor();
  for (const column of ['platform_tilt_percent', 'A_friction_percent', 'B_friction_percent']) {
    const value = Number(await budgets.getByTestId(`value-${column}`).getAttribute('data-value'));
    expect(value, column).toBeGreaterThanOrEqual(0);
    expect(value, column).toBeLessThanOrEqual(100);
  }
  await page.getByTestId('cell-plots-toggle').click();
  await page.getByTestId('cell-play-scale').fill('0');
});

const stationLabels = () => page.evaluate(() => [...window.jointplay.probe.cell!.labels()].sort().join());

test('parts are hidden, isolated and followed, the path of a wafer is drawn', async () => {
  await choose('Bodies', 'wall');
  await page.getByTestId('part-hide').click();
  await until('the wall is hidden', async () => !(await shown()).includes('wall'));
  await page.getByTestId('show-all').click();
  await until('the wall is shown', async () => (await shown()).includes('wall'));
  await page.getByTestId('part-isolate').click();
  await until('only the wall is shown', async () => (await shown()).join() === 'wall');
  await until('hidden stations have no labels', async () => (await stationLabels()) === '');
  await until('there is no line between hidden parts', async () => (await page.evaluate(() => window.jointplay.probe.cell!.nearest())).length === 0);
  await page.locator('.scene canvas').first().focus();
  await page.keyboard.press('i');
  await until('all is shown', async () => (await shown()).length > 10);
  await page.getByTestId('cell-time').fill('0');
  await choose('Wafers', 'wafer of LP2 1');
  await page.getByTestId('part-trace').click();
  await page.getByTestId('untrace').click();
  await page.getByTestId('part-follow').click();
  const [eye, wafer] = [(await camera()).eye, await origin('wafer of LP2 1')];
  await page.getByTestId('cell-time').fill(await page.getByTestId('cell-time').getAttribute('max').then(String));
  await until('the wafer is elsewhere', async () => Math.abs((await origin('wafer of LP2 1'))[0]! - wafer[0]!) > 0.3);
  const moved = await origin('wafer of LP2 1');
  const followed = (await camera()).eye;
  followed.forEach((value, k) => expect(value - eye[k]!).toBeCloseTo(moved[k]! - wafer[k]!, 5));
  await page.getByTestId('unfollow').click();
});

test('distances are measured between two clicked points, and a section plane cuts the picture', async () => {
  await page.getByTestId('measure').click();
  const box = (await page.locator('.scene canvas').first().boundingBox())!;
  const at = async (x: number, y: number) => page.mouse.click(box.x + x * box.width, box.y + y * box.height);
  await page.getByRole('button', { name: 'Top', exact: true }).click();
  await page.getByTestId('measured').filter({ hasText: 'Click the first point' }).waitFor();
  let found = 0;
  for (let k = 0; k < 60 && found < 2; k += 1) {
    await at(0.25 + 0.05 * (k % 10), 0.35 + 0.05 * Math.floor(k / 10));
    const text = (await page.getByTestId('measured').textContent())!;
    found = text.includes('Δx') ? 2 : text.includes('First point') ? 1 : 0;
  }
  const text = (await page.getByTestId('measured').textContent())!;
  const [length, ...by] = [...text.matchAll(/(-?[\d,]+\.\d+) mm/g)].map(([, value]) => Number(value!.replaceAll(',', '')));
  expect(by.length).toBe(3);
  expect(Math.hypot(...by)).toBeCloseTo(length!, 1);
  await page.getByTestId('measure').click();
  const frames = () => page.evaluate(() => window.jointplay.probe.cellFrames);
  const before = await frames();
  await page.getByTestId('section').selectOption('z');
  await page.getByTestId('section-at').fill('0.55');
  await until('the cut is drawn', async () => (await frames()) > before);
  // The carriers are at x = -495 mm, aligner and process station at x > 0.
  await page.getByTestId('section').selectOption('x');
  await page.getByTestId('section-at').fill('0');
  await until('stations that are cut away have no labels', async () => (await stationLabels()) === 'LP1,LP2');
  await expect.poll(() => accessibilityViolations(page)).toEqual([]);
  await page.getByTestId('section').selectOption('');
});

test('the chart has an overview in which a time range is chosen', async () => {
  const box = (await page.getByTestId('gantt').boundingBox())!;
  const y = box.y + box.height - 6;
  await page.mouse.move(box.x + 0.3 * box.width, y);
  await page.mouse.down();
  await page.mouse.move(box.x + 0.5 * box.width, y);
  await page.mouse.move(box.x + 0.6 * box.width, y);
  await page.mouse.up();
  await page.getByRole('button', { name: 'Fit time' }).waitFor();
  await page.mouse.click(box.x + 0.8 * box.width, y);
  const duration = Number(await page.getByTestId('cell-time').getAttribute('max'));
  await until('it is there', async () => Math.abs((await now()) / duration - 0.79) < 0.05);
  await page.getByRole('button', { name: 'Fit time' }).click();
});

test('the keyboard sheet is that of this view', async () => {
  await page.locator('.scene canvas').first().focus();
  await page.keyboard.press('?');
  const sheet = page.getByRole('dialog');
  await sheet.getByText('isolate the selected part').waitFor();
  await expect.poll(() => sheet.textContent()).toContain('measure the distance');
  await expect.poll(() => accessibilityViolations(page)).toEqual([]);
  await page.keyboard.press('Escape');
});

test('violations are grouped by pair with their places, and a motion with violations is exported only on request', async () => {
  await page.getByRole('tab', { name: 'Cell file' }).click();
  await page.getByTestId('text-cell').locator('.cm-content').click();
  await page.keyboard.press('Control+a');
  await page.keyboard.insertText(CELL.replace('position_mm = [100.0, -600.0, 500.0]', 'position_mm = [-330.0, -330.0, 500.0]'));
  await waitForCheck(page, 'failed');
  const groups = page.getByTestId('violations').locator(':scope > li');
  const { report } = (await (await fetch(`${fixture.server.address}api/v1/cell/plan`, { method: 'POST', headers: { 'content-type': 'application/json' }, body: JSON.stringify({ cell: CELL.replace('position_mm = [100.0, -600.0, 500.0]', 'position_mm = [-330.0, -330.0, 500.0]'), program: PROGRAM }) })).json()) as { report: { violation_groups: { count: number; occurrences: { line: number }[] }[] } };
  await expect.poll(() => groups.count()).toBe(report.violation_groups.length);
  await expect.poll(() => groups.first().locator('.count').first().textContent()).toBe(String(report.violation_groups[0]!.count));
  await groups.first().locator('summary').click();
  const place = groups.first().locator('details li button').first();
  await expect.poll(() => place.textContent()).toContain(`line ${report.violation_groups[0]!.occurrences[0]!.line}: `);
  await place.click();
  await page.getByTestId('current-violations').first().waitFor();
  for (const theme of ['light', 'dark']) {
    await page.getByLabel('Theme').selectOption(theme);
    await expect.poll(() => accessibilityViolations(page)).toEqual([]);
  }
  await page.getByTestId('cell-export').click();
  await expect.poll(() => page.getByTestId('cell-export-csv').isDisabled()).toBe(true);
  await expect.poll(() => accessibilityViolations(page, '.menu')).toEqual([]);
  await page.getByTestId('cell-export-despite').check();
  const awaited = page.waitForEvent('download');
  await page.getByTestId('cell-export-csv').click();
  expect((await awaited).suggestedFilename()).toBe('mine-not-safe-to-run.csv');
});
