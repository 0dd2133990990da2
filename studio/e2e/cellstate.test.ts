// The cell view states what it shows: jogged and outdated results, films that end, measured points that move with their parts.

import { afterAll, afterEach, beforeAll, expect, test } from 'vitest';
import type { Page } from 'playwright-core';
import { EXAMPLE_CELL, SHORT_PROGRAM, cellFixture, complaints, load, partNames, unhandled, until, visit, waitForCheck, type CellFixture } from './studio';

// LP2 is tilted: there the platform has play.
const PROGRAM = 'HOME\nGET LP2 SLOT 1 WITH A\nHOME\n';

let fixture: CellFixture;
let page: Page;
let heard: string[];

beforeAll(async () => {
  fixture = await cellFixture(PROGRAM, EXAMPLE_CELL.replace('name = "LP2"', 'name = "LP2"\nwafers = "all"'));
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

const plots = () => page.getByTestId('cell-plots').getAttribute('data-state');

test('budget and plots are marked while the robot is jogged and while the check is outdated', async () => {
  await page.getByTestId('cell-plots-toggle').click();
  await page.getByTestId('plot-play').locator('canvas').waitFor();
  await expect.poll(() => plots()).toBe('current');
  await page.getByTestId('field-jog-T').fill('20');
  await page.getByTestId('field-jog-T').press('Enter');
  await page.getByTestId('jogged').waitFor();
  await until('the plots are marked', async () => (await plots()) === 'jogged');
  await page.getByTestId('cell-play-budget').filter({ hasText: 'Jogged:' }).waitFor();
  await page.getByTestId('jog-release').click();
  await until('the plots are those of the view', async () => (await plots()) === 'current');
  await page.route('**/api/v1/cell/plan', () => undefined);
  await page.getByTestId('text-program').locator('.cm-content').click();
  await page.keyboard.press('Control+End');
  await page.keyboard.insertText('WAIT 1\n');
  await until('the plots are outdated', async () => (await plots()) === 'outdated');
  await expect.poll(() => page.getByTestId('cell-play-budget').getAttribute('data-outdated')).toBe('true');
  await page.unroute('**/api/v1/cell/plan');
  await page.locator('.files').getByRole('button', { name: 'Undo' }).click();
  await waitForCheck(page, 'passed');
  await page.getByTestId('cell-plots-toggle').click();
});

test('legend and play scale do not cover each other', async () => {
  await page.getByTestId('cell-play-scale').fill('600');
  for (const viewport of [{ width: 1440, height: 900 }, { width: 390, height: 844 }]) {
    await page.setViewportSize(viewport);
    const boxes = async () => Promise.all([page.getByTestId('play-scale-note'), page.getByRole('list', { name: 'Legend' })].map((part) => part.boundingBox()));
    await until('both are inside the window', async () => (await boxes()).every((box) => box !== null && box.x >= 0 && box.x + box.width <= viewport.width));
    const [scale, legend] = (await boxes()) as { x: number; y: number; width: number; height: number }[];
    const apart = scale!.x + scale!.width <= legend!.x || legend!.x + legend!.width <= scale!.x || scale!.y + scale!.height <= legend!.y || legend!.y + legend!.height <= scale!.y;
    expect(apart, `${viewport.width} px`).toBe(true);
  }
  await page.setViewportSize({ width: 1440, height: 900 });
  await page.getByTestId('cell-play-scale').fill('0');
});

test('only the left button chooses a time range', async () => {
  const box = (await page.getByTestId('gantt').boundingBox())!;
  const y = box.y + box.height - 6;
  await page.mouse.move(box.x + 0.3 * box.width, y);
  await page.mouse.down({ button: 'right' });
  await page.mouse.move(box.x + 0.6 * box.width, y, { steps: 4 });
  await page.mouse.up({ button: 'right' });
  await expect.poll(() => page.getByRole('button', { name: 'Fit time' }).count()).toBe(0);
});

test('measured points move with their parts', async () => {
  await page.getByRole('button', { name: 'Top', exact: true }).click();
  await page.getByTestId('measure').click();
  const box = (await page.locator('.scene canvas').first().boundingBox())!;
  const measured = async () => (await page.getByTestId('measured').textContent())!;
  // The first point is on an arm, the second one on a part that does not move.
  const robot = await page.evaluate(async () => (await (await fetch('./api/v1/cell/plan', { method: 'POST', headers: { 'content-type': 'application/json' }, body: '{}' })).json()) as { robot: { arms: { links: string[] }[] }; bodies: { name: string; attached_to: string }[] });
  const links = robot.robot.arms.flatMap((arm) => arm.links);
  const moving = new Set([...links, ...robot.bodies.filter(({ attached_to }) => links.includes(attached_to)).map(({ name }) => name)]);
  // A third click begins another measurement: the points go outward from the centre, until one is on an arm and the other one is not.
  let pair: string[] = [];
  const isOnArm = (name: string) => moving.has(name);
  for (let k = 0; k < 400 && pair.filter(isOnArm).length !== 1; k += 1) {
    const [radius, turn] = [0.38 * Math.sqrt(k / 400), 2.399963 * k];
    await page.mouse.click(box.x + box.width / 2 + radius * box.height * Math.cos(turn), box.y + box.height * (0.55 + radius * Math.sin(turn)));
    pair = /^(.*) – (.*): [\d−]/.exec(await measured())?.slice(1) ?? [];
  }
  const link = pair.find(isOnArm)!;
  const before = await measured();
  expect(before).toContain('Δx');
  await page.getByTestId('cell-time').fill(String(0.4 * Number(await page.getByTestId('cell-time').getAttribute('max'))));
  await until('the distance is another one', async () => (await measured()) !== before);
  await expect.poll(() => measured()).toContain(link);
  await page.getByTestId('measure').click();
});

test('a film ends when the motion is paused, and when the view is left', async () => {
  const record = async (end: () => Promise<void>) => {
    await page.getByTestId('cell-time').fill('0');
    await page.getByTestId('cell-export').click();
    const awaited = page.waitForEvent('download');
    await page.getByTestId('cell-export-video').click();
    await page.getByTestId('cell-stop-recording').waitFor();
    await until('the motion is recorded', async () => Number(await page.getByTestId('cell-now').getAttribute('data-time')) > 0.05);
    await end();
    const download = await awaited;
    expect(download.suggestedFilename()).toMatch(/^mine\.(mp4|webm)$/);
  };
  await record(() => page.getByTestId('cell-play').click());
  await expect.poll(() => page.getByTestId('cell-stop-recording').count()).toBe(0);
  await record(() => page.getByRole('button', { name: 'Robot', exact: true }).click());
  await page.getByRole('button', { name: 'Cell', exact: true }).click();
  await until('the cell is drawn again', async () => (await partNames(page)).length > 0);
});

test('an export that is cancelled downloads nothing, and another one can follow', async () => {
  await waitForCheck(page, 'passed');
  let held: (() => void) | null = null;
  await page.route('**/api/v1/cell/export', (route) => new Promise<void>((go) => (held = () => go(void route.continue().catch(() => undefined)))));
  await page.getByTestId('cell-export').click();
  await page.getByTestId('cell-export-csv').click();
  await until('the request is pending', async () => held !== null);
  await page.getByTestId('cell-export').click();
  await expect.poll(() => page.getByTestId('cell-export-csv').isDisabled()).toBe(true);
  await page.keyboard.press('Escape');
  await page.getByTestId('cell-export-cancel').click();
  await until('nothing is exported', async () => (await page.getByTestId('cell-export').textContent()) === 'Export');
  held!();
  await page.unroute('**/api/v1/cell/export');
  await page.getByTestId('cell-export').click();
  const awaited = page.waitForEvent('download');
  await page.getByTestId('cell-export-csv').click();
  expect((await awaited).suggestedFilename()).toBe('mine.csv');
});

test('a link with a time range beyond the motion shows the part within', async () => {
  const duration = Number(await page.getByTestId('cell-time').getAttribute('max'));
  const other = await visit(fixture.browser, { viewport: { width: 1024, height: 700 } });
  try {
    await load(other, `${fixture.server.address}#cell=mine.toml&time=1&tab=program&range=2,${duration + 500}`);
    await waitForCheck(other, 'passed');
    await other.getByRole('button', { name: 'Fit time' }).waitFor();
  } finally {
    await other.context().close();
  }
});

test('the chart of the axes shows which part of the motion is not loaded', async () => {
  let answer = () => {};
  const asked = new Promise<void>((done) => (answer = done));
  await page.route('**/api/v1/cell/windows/*', async (route) => {
    await asked;
    await route.continue();
  });
  const loading = () => page.getByTestId('gantt').getAttribute('data-loading');
  await expect.poll(() => loading()).toBe('false');
  await load(page, fixture.server.address);
  await waitForCheck(page, 'passed');
  await until('the chart has a gap', async () => (await loading()) === 'true');
  answer();
  await until('the chart is complete', async () => (await loading()) === 'false');
  await page.unroute('**/api/v1/cell/windows/*');
});

/** A cell of parts whose arm has no bodies. */
const BARE = `kind = "cell"
name = "Bare arm"
robot = "scara-4r"
assumed = ["places: drawn, not measured"]
wafer = { diameter_mm = 300.0, thickness_mm = 0.775, material = "silicon" }
budgets = { virtual_joint_norm_um = 60.0, plane_urad = 200.0, min_distance_mm = 1.0, slot_min_distance_mm = 1.0 }
part = [
  { part = "load-port", name = "LP", position_mm = [-520, 0, 500], heading_deg = 90, approach = "line", retract_mm = 200.0, wafers = "all" },
  { part = "wafer-rest", name = "REST", position_mm = [0, 520, 560], heading_deg = 0, approach = "line", retract_mm = 200.0 },
]
`;

test('an arm without bodies is listed as not checked for collisions', async () => {
  const unchecked = () => page.getByTestId('unchecked').allTextContents();
  const result = () => page.getByTestId('check-result').locator('.good, .soft').first().textContent();
  await expect.poll(async () => [await unchecked(), await result()]).toEqual([[], 'No violations of reach, limits, slip, collision or zones.']);
  const bare = await cellFixture('HOME\nTRANSFER LP SLOT 1 TO REST\nHOME\n', BARE);
  try {
    await load(page, bare.server.address);
    await waitForCheck(page, 'passed');
    await expect.poll(async () => [await unchecked(), await result()]).toEqual([['Not checked for collisions: arm “arm”. The cell file has no bodies for it.'], 'No violations in what was checked.']);
    await page.getByTitle('Length unit').selectOption('inch');
    await until('distances are in inches', async () => /^0\.\d+ in$/.test((await page.getByTestId('check-result').locator('xpath=..').locator('td.number').first().textContent()) ?? ''));
  } finally {
    await page.goto('about:blank');
    await bare.close();
  }
});

test('lengths of violations, their places, jog and parts are in the display unit', async () => {
  const wall = '[[body]]\nname = "wall-5mm"\nbox = { size_mm = [5, 600, 600] }\nposition_mm = [-300, 300, 600]\n';
  const blocked = await cellFixture(SHORT_PROGRAM, `${EXAMPLE_CELL}\n${wall}`);
  try {
    await load(page, blocked.server.address);
    await until('violations', async () => (await page.getByTestId('violations').count()) === 1);
    const violations = () => page.getByTestId('violations').textContent();
    const depth = Number(/wall-5mm.*? depth of ([\d.]+) mm/.exec((await violations())!)![1]);
    await page.getByTestId('violations').locator('button').first().click();
    await page.getByTitle('Length unit').selectOption('inch');
    await until('violations are in inches', async () => / depth of [\d.]+ in\b/.test((await violations())!));
    const shown = (await violations())!;
    expect(Number(/wall-5mm.*? depth of ([\d.]+) in/.exec(shown)![1])).toBeCloseTo(depth / 25.4, 3);
    expect(shown).not.toMatch(/\d (mm|µm)/);
    await until('the violation at the current time is in inches', async () => / [\d.]+ in\b/.test((await page.getByTestId('current-violations').textContent()) ?? ''));
    await expect.poll(async () => (await page.getByTestId('current-violations').textContent())!).not.toMatch(/\d (mm|µm)/);
    await page.getByTitle('Length unit').selectOption('mm');
  } finally {
    await page.goto('about:blank');
    await blocked.close();
  }
});
