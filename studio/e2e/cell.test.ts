// The cell view: display, playback, check, editing, saving.

import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import type { Page } from 'playwright-core';
import { afterAll, afterEach, beforeAll, expect, test } from 'vitest';
import { EXAMPLE_CELL, SHORT_PROGRAM, accessibilityViolations, cellFixture, checkState, complaints, frames, load, partNames, serve, unhandled, until, visit, waitForCheck, type CellFixture } from './studio';

let fixture: CellFixture;
let page: Page;
let heard: string[];

beforeAll(async () => {
  fixture = await cellFixture();
  page = await visit(fixture.browser);
  heard = complaints(page);
  await load(page, fixture.server.address);
});
afterAll(() => fixture?.close());
afterEach(() => {
  // Windows of a plan that a quick edit has replaced are answered by 404, which the page handles.
  expect(unhandled(heard.splice(0))).toEqual([]);
});

const checkResult = (state: string) => waitForCheck(page, state);
const now = async () => Number(await page.getByTestId('cell-now').getAttribute('data-time'));

/** Puts other text into an editor, as typing does. */
async function write(kind: 'program' | 'cell', text: string): Promise<void> {
  await page.getByRole('tab', { name: kind === 'program' ? 'Program' : 'Cell file' }).click();
  await page.getByTestId(`text-${kind}`).locator('.cm-content').click();
  await page.keyboard.press('Control+a');
  await page.keyboard.insertText(text);
}

test('the cell is displayed with its named parts, and its program is safe to run', async () => {
  await checkResult('passed');
  await until('the cell is drawn', async () => (await partNames(page)).length > 0 && (await page.evaluate(() => window.jointplay.probe.cellFrames > 0)));
  const parts = await partNames(page);
  for (const name of ['wall', 'optics', 'blade-A', 'LP1-left']) expect(parts).toContain(name);
});

test('the program is played by keyboard, slider and steps', async () => {
  await page.getByTestId('check-result').click();
  await page.keyboard.press(' ');
  await until('it plays', async () => (await now()) > 0.5);
  await page.keyboard.press(' ');
  const stopped = await now();
  await frames(page);
  await expect.poll(() => now()).toBe(stopped);
  await page.getByTestId('cell-time').fill('0');
  await expect.poll(() => now()).toBe(0);
  await page.getByRole('tab', { name: 'Steps' }).click();
  await page.getByTestId('steps').getByRole('button', { name: /PUT ALIGN/ }).click();
  await expect.poll(() => now()).toBeGreaterThan(1);
  await expect.poll(() => page.getByTestId('cell-step').textContent()).toContain('line 3');
  await page.getByTestId('steps').getByRole('button', { name: /lower/ }).first().click();
  await expect.poll(() => page.getByTestId('cell-step').textContent()).toContain('lower');
  const gantt = (await page.getByTestId('gantt').boundingBox())!;
  await page.getByTestId('gantt').click({ position: { x: gantt.width - 40, y: 60 } });
  await expect.poll(() => page.getByTestId('cell-step').textContent()).toContain('line 4');
});

test('errors are marked in their lines', async () => {
  await write('program', 'HOME\nGET LP9 SLOT 1 WITH A\n');
  await checkResult('refused');
  await page.getByTestId('diagnostics').filter({ hasText: 'line 2, column 5' }).filter({ hasText: 'LP9' }).waitFor();
  await page.getByTestId('text-program').locator('.cm-lintRange-error', { hasText: 'LP9' }).waitFor();
  await write('program', SHORT_PROGRAM);
  await checkResult('passed');
});

test('a collision is listed and marked at its time, in its line and in the 3D view', async () => {
  await write('cell', EXAMPLE_CELL.replace('position_mm = [100.0, -600.0, 500.0]', 'position_mm = [-330.0, 330.0, 500.0]'));
  await checkResult('failed');
  const first = page.getByTestId('violations').getByRole('button').first();
  await expect.poll(() => first.textContent()).toContain('wall');
  await first.click();
  await page.getByTestId('current-violations').filter({ hasText: 'wall' }).waitFor();
  await page.getByTestId('text-program').locator('.cm-lintRange-warning').first().waitFor();
  await page.keyboard.press('Escape');
  await page.getByRole('button', { name: 'Undo' }).click();
  await checkResult('passed');
});

test('an excessive tilt of a station is fixed, and saving preserves comments', async () => {
  await page.locator('summary', { hasText: 'LP1' }).click();
  await page.getByTestId('station-LP1-tilt').fill('2');
  await page.getByTestId('station-LP1-tilt').press('Enter');
  await checkResult('refused');
  await page.getByTestId('diagnostics').filter({ hasText: 'LP1' }).filter({ hasText: 'tilts 2.000°' }).waitFor();
  await page.getByTestId('diagnostics').getByRole('button').first().click();
  await page.getByTestId('text-cell').locator('.cm-lintRange-error').first().waitFor();
  await page.getByRole('button', { name: 'Undo' }).click();
  await checkResult('passed');
  await page.getByTestId('station-LP1-x').fill('-494');
  await page.getByTestId('station-LP1-x').press('Enter');
  await until('it can be kept', () => page.getByTestId('save').isEnabled());
  await checkResult('passed');
  await page.getByTestId('save').click();
  await until('it is saved', () => page.getByTestId('save').isDisabled());
  const kept = readFileSync(join(fixture.folder, 'mine.toml'), 'utf8');
  expect(kept).toContain('-494');
  expect(kept.match(/^\s*#/gm)).toEqual(EXAMPLE_CELL.match(/^\s*#/gm));
});

/** The server's answer to a jog of the texts in the files. */
async function asked(question: object): Promise<{ axes: { name: string; position: number }[]; from_slot: Record<string, number> | null; effectors: { center_m: number[] }[] }> {
  const answer = await fetch(`${fixture.server.address}api/v1/cell/jog`, { method: 'POST', headers: { 'content-type': 'application/json' }, body: JSON.stringify(question) });
  expect(answer.status).toBe(200);
  return answer.json() as never;
}
const value = async (name: string) => Number(await page.getByTestId(`field-jog-${name}`).inputValue());
const origin = (name: string) => page.evaluate((of) => window.jointplay.probe.cell!.origin(of)!, name);

test('jogging an axis moves the 3D model and stops at limits with a message', async () => {
  await page.getByTestId('cell-time').fill('0');
  const before = await origin('upper link 4');
  await until('the axes are there', async () => (await value('T')) === 0);
  // These tests are about the robot's own limits; `jog.test.ts` is about contacts.
  await page.getByTestId('jog-stop').uncheck();
  await page.getByRole('button', { name: 'Increase T by 1 °' }).click();
  await page.getByRole('button', { name: 'Increase T by 1 °' }).click();
  await page.getByTestId('jogged').waitFor();
  await until('it turned by two degrees', async () => (await value('T')) === 2);
  await until('it is seen', async () => (await origin('upper link 4')).some((part, k) => Math.abs(part - before[k]!) > 1e-3));
  const { axes } = await asked({ to: { kind: 'axes', positions: [0.5, 0.5, 0.5, (2 * Math.PI) / 180, (-40 * Math.PI) / 180, (-40 * Math.PI) / 180] } });
  expect(axes.find(({ name }) => name === 'T')!.position).toBeCloseTo((2 * Math.PI) / 180, 12);
  // A value beyond the stops is limited to them.
  await page.getByTestId('field-jog-RA').fill('95');
  await page.getByTestId('field-jog-RA').press('Enter');
  await until('it is at its stop', async () => (await value('RA')) === 80);
  await page.locator('#jog-fields [role=alert]', { hasText: 'RA ranges from -45 to 80 °' }).waitFor();
  // One rod alone meets the limit of tilt, which the server reports.
  await page.getByTestId('field-jog-q1').fill('520');
  await page.getByTestId('field-jog-q1').press('Enter');
  await page.getByTestId('jog-stopped').filter({ hasText: 'tilt of' }).filter({ hasText: 'limit 1.5000°' }).waitFor();
  await expect.poll(() => value('q1')).toBeLessThan(520);
  await page.getByTestId('jog-release').click();
  await until('it is back in the program', async () => (await value('RA')) === -40 && (await page.getByTestId('jogged').count()) === 0);
  // The 3D view follows with its next frame.
  await until('the link is back', async () => (await origin('upper link 4')).every((part, k) => part === before[k]));
});

test('jogging in station, world and platform coordinates shows the values of the server', async () => {
  await page.locator('#jog-slot').click();
  await page.getByTestId('jog-station').selectOption('LP2');
  await page.getByTestId('jog-slot').fill('5');
  await page.getByTestId('jog-slot').press('Enter');
  await page.getByTestId('jog-in').click();
  await until('it is in the slot', async () => (await value('radial')) === 0 && (await value('turn')) === 0 && (await value('z')) === 0);
  await page.getByTestId('field-jog-z').fill('3');
  await page.getByTestId('field-jog-z').press('Enter');
  await until('it is above', async () => (await value('z')) === 3);
  await page.locator('#jog-world').click();
  const { effectors } = await asked({ seen_from: { station: 'LP2', slot: 5 }, to: { kind: 'slot', radial_m: 0, turn_rad: 0, height_m: 0.003, heading_rad: 0 } });
  for (const [k, name] of ['x', 'y', 'z'].entries()) await until(`${name} is that of the server`, async () => Math.abs((await value(name)) - effectors[0]!.center_m[k]! * 1000) < 5e-4);
  await page.getByTestId('field-jog-x').fill('-900');
  await page.getByTestId('field-jog-x').press('Enter');
  await page.getByTestId('jog-stopped').filter({ hasText: 'out of reach' }).waitFor();
  await until('it stopped within reach', async () => (await value('x')) > -700);
  await page.getByText(/inverse-kinematics branch(es)? for A/).click();
  await page.getByTestId('jog-branches').getByText('chosen').first().waitFor();
  await page.locator('#jog-platform').click();
  await page.getByTestId('field-jog-height').fill('520');
  await page.getByTestId('field-jog-height').press('Enter');
  await until('it is higher', async () => (await value('height')) === 520);
  await page.getByTestId('jog-home').click();
  await until('it is home', async () => (await value('height')) === 500);
});

test('a station is taught by position and by plane points, and undo restores it', async () => {
  const undo = page.getByRole('button', { name: 'Undo' });
  const text = async () => page.evaluate(async () => ((await (await fetch('./api/v1/cell')).json()) as { cell: string }).cell);
  const kept = await text();
  await page.locator('#jog-slot').click();
  await page.getByTestId('jog-station').selectOption('ALIGN');
  await page.getByTestId('jog-in').click();
  await until('it is in the slot', async () => (await value('radial')) === 0 && (await value('z')) === 0);
  await page.getByTestId('field-jog-z').fill('2.5');
  await page.getByTestId('field-jog-z').press('Enter');
  await until('it is above', async () => (await value('z')) === 2.5);
  await page.getByTestId('teach-ALIGN-position').click();
  await until('the station is there', async () => Number(await page.getByTestId('station-ALIGN-z').inputValue()) === 602.5);
  await until('and sees the wafer in its slot', async () => (await value('z')) === 0);
  await undo.click();
  await until('the station is back', async () => Number(await page.getByTestId('station-ALIGN-z').inputValue()) === 600);
  // Points of the plane, so near that no blade touches a ledge: two wait, the third makes it, of a fourth the noise is still unknown.
  for (const [radial, turn] of [[-30, 0], [0, 1], [0, -1], [-20, 0.5]] as const) {
    for (const [name, to] of [['radial', radial], ['turn', turn], ['z', 0]] as const) {
      await page.getByTestId(`field-jog-${name}`).fill(String(to));
      await page.getByTestId(`field-jog-${name}`).press('Enter');
      await until(`${name} is ${to}`, async () => Math.abs((await value(name)) - to) < 2e-4);
    }
    const points = await page.getByTestId('points-ALIGN').locator('li').count();
    await page.getByTestId('teach-ALIGN-point').click();
    await until('the point is taken', async () => (await page.getByTestId('points-ALIGN').locator('li').count()) === points + 1);
    if (points === 1) await page.getByTestId('plane-ALIGN').filter({ hasText: '2 of 3 points' }).waitFor();
    if (points === 2) await page.getByTestId('plane-ALIGN').filter({ hasText: 'add a fourth to verify' }).waitFor();
    if (points === 3) await page.getByTestId('plane-ALIGN').filter({ hasText: 'too few points to test them' }).waitFor();
  }
  for (let k = 0; k < 4; k += 1) await undo.click();
  await until('no point is left', async () => (await page.getByTestId('points-ALIGN').count()) === 0);
  await checkResult('passed');
  await expect.poll(() => text()).toBe(kept);
  await page.getByTestId('jog-release').click();
});

const grip = (freedom: string) => page.evaluate((of) => window.jointplay.probe.cell!.grip(of as never), freedom);
/** Selects a part in the list; a click on the selected part would clear the selection. */
const choose = async (name: string) => {
  await page.getByRole('tab', { name: 'Parts' }).click();
  const part = page.getByTestId('parts').getByRole('button', { name: new RegExp(`^${name}`) });
  if ((await part.getAttribute('aria-pressed')) !== 'true') await part.click();
  await until(`${name} is selected`, async () => (await part.getAttribute('aria-pressed')) === 'true');
};
/** Drags a handle, and calls `held` before the handle is released. */
async function drag(freedom: string, up: number, held: () => Promise<void> = async () => undefined): Promise<void> {
  await until(`there is a handle for ${freedom}`, async () => (await grip(freedom)) !== null);
  const from = (await grip(freedom))!;
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  await page.mouse.move(from.x, from.y - up / 2);
  await page.mouse.move(from.x, from.y - up);
  await held();
  await page.mouse.up();
}

test('a station is dragged by the handles of its degrees of freedom in one undo step', async () => {
  await choose('PM1');
  await until('the handles are there', async () => (await grip('x')) !== null);
  await expect.poll(() => grip('height'), { message: 'its height comes from taught points' }).toBe(null);
  await choose('ALIGN');
  const z = async () => Number(await page.getByTestId('station-ALIGN-z').inputValue());
  await expect.poll(() => z()).toBe(600);
  await drag('height', 12, async () => expect(await z(), 'the field follows').toBeGreaterThan(601));
  // The result is outdated from the drag until the new plan.
  await until('it is replanned', async () => (await checkState(page)) !== 'outdated' && (await z()) > 601);
  await page.getByRole('button', { name: 'Undo' }).click();
  await until('one step takes it back', async () => (await z()) === 600);
  await checkResult('passed');
});

test('wafers and bodies of a station move with it during a drag and after planning', async () => {
  await page.getByTestId('cell-time').fill('0');
  await choose('LP1');
  const field = (name: string) => page.getByTestId(`station-LP1-${name}`).inputValue().then(Number);
  const places = async () => Promise.all(['LP1 3', 'wafer of LP1 3', 'wafer of LP1 25', 'LP1-left', 'LP1-back'].map(origin));
  const wall = await origin('wall');
  const [before, z] = [await places(), await field('z')];
  const off = (to: number[][]) => to.map((place, k) => place.map((value, i) => (value - before[k]![i]!) * 1000));
  let shown: number[][] = [];
  await drag('height', 14, async () => {
    await until('the field follows', async () => (await field('z')) > z + 0.5);
    shown = await places();
    const moved = (await field('z')) - z;
    // Single precision at half a metre is 30 nm.
    for (const by of off(shown)) [0, 0, moved].forEach((value, i) => expect(by[i]).toBeCloseTo(value, 4));
    await expect.poll(() => origin('wall'), { message: 'what is not of the station stays' }).toEqual(wall);
  });
  await checkResult('passed');
  // Single precision is what the file of the picture has.
  await until('the server reports the same', async () => (await places()).every((place, k) => place.every((value, i) => Math.abs(value - shown[k]![i]!) < 1e-6)));
  await page.getByRole('button', { name: 'Undo' }).click();
  await until('it is back', async () => off(await places()).every((by) => by.every((value) => Math.abs(value) < 1e-3)));
  const tilt = await field('tilt');
  await drag('about_y', 20, async () => {
    await until('it is tilted', async () => Math.abs((await field('tilt')) - tilt) > 0.05);
    shown = await places();
    // The slot on top moves far as the station tilts about its lowest.
    expect(Math.hypot(...off(shown)[2]!)).toBeGreaterThan(0.2);
  });
  await checkResult('passed');
  await until('the server reports the same', async () => (await places()).every((place, k) => place.every((value, i) => Math.abs(value - shown[k]![i]!) < 1e-6)));
  await page.getByRole('button', { name: 'Undo' }).click();
  await until('it is back', async () => off(await places()).every((by) => by.every((value) => Math.abs(value) < 1e-3)));
});

test('a station defined by its first and last slot keeps its definition when it is moved and tilted', async () => {
  const carrier_axis = 'carrier_axis = { first_mm = [-495.0, -495.0, 500.0], last_mm = [-495.5, -492.0, 740.0] } # as measured';
  const text = EXAMPLE_CELL.replace('position_mm = [-495.0, -495.0, 500.0]', carrier_axis).replace('tilt = { azimuth_deg = 100.0, angle_deg = 0.8 }\n', '');
  await write('cell', text);
  await until('it is planned so', async () => (await page.getByText('LP2', { exact: false }).filter({ hasText: 'carrier axis' }).count()) > 0);
  await checkResult('passed');
  await choose('LP2');
  for (const freedom of ['x', 'y', 'height', 'heading', 'about_x', 'about_y']) await until(`it has ${freedom}`, async () => (await grip(freedom)) !== null);
  await drag('height', 14);
  const kept = async () => {
    await checkResult('passed');
    await page.getByTestId('save').click();
    await until('it is saved', () => page.getByTestId('save').isDisabled());
    const [, first, last] = /carrier_axis = \{ first_mm = \[(.*?)\], last_mm = \[(.*?)\] \} # as measured/.exec(readFileSync(join(fixture.folder, 'mine.toml'), 'utf8'))!;
    return [first!, last!].map((words) => words.split(',').map(Number));
  };
  await until('it is higher', async () => Number(await page.getByTestId('station-LP2-z').inputValue()) > 500.5);
  const [first, last] = await kept();
  expect(first![2]).toBeGreaterThan(500.5);
  expect(last![2]! - first![2]!).toBeCloseTo(240, 9);
  expect(last!.slice(0, 2)).toEqual([-495.5, -492]);
  await drag('about_x', 8);
  await until('its tilt changes', async () => Math.abs(Number(await page.getByTestId('station-LP2-tilt').inputValue()) - 0.726) > 0.02);
  const [still, turned] = await kept();
  expect(still).toEqual(first);
  expect(turned).not.toEqual(last);
  const long = (to: number[]) => Math.hypot(...to.map((value, k) => value - first![k]!));
  expect(long(turned!)).toBeCloseTo(long(last!), 6);
  for (let k = 0; k < 3; k += 1) await page.getByRole('button', { name: 'Undo' }).click();
  await until('it is as drawn', async () => (await page.getByText('LP2', { exact: false }).filter({ hasText: 'carrier axis' }).count()) === 0);
  await checkResult('passed');
  await page.getByTestId('save').click();
});

test('a selected part is highlighted in the 3D view, and its properties are listed', async () => {
  await page.getByRole('tab', { name: 'Parts' }).click();
  await page.getByTestId('parts').getByText('Bodies').click();
  await page.getByTestId('parts').getByRole('button', { name: 'blade-A' }).click();
  await until('it is marked', async () => (await page.evaluate(() => window.jointplay.probe.cell!.selected())).includes('blade-A'));
  await expect.poll(() => page.getByTestId('properties').textContent()).toContain('300.00 mm × 220.00 mm × 3.00 mm');
  await page.getByTestId('parts').getByText('Arm lower').click();
  await page.getByTestId('parts').getByRole('button', { name: 'lower whole arm' }).click();
  await until('the whole arm is marked', async () => (await page.evaluate(() => window.jointplay.probe.cell!.selected())).includes('blade-B'));
  await page.getByRole('tab', { name: 'Program' }).click();
});

test('positions and velocities are plotted over the time range of the chart', async () => {
  await page.getByTestId('cell-plots-toggle').click();
  await page.getByTestId('plot-revolute').locator('canvas').waitFor();
  await expect.poll(() => page.getByTestId('cell-plots').locator('figure').count()).toBe(7);
  const box = (await page.getByTestId('plot-revolute').locator('.u-over').boundingBox())!;
  await page.getByTestId('plot-revolute').locator('.u-over').click({ position: { x: box.width / 2, y: box.height / 2 } });
  const at = await now();
  const duration = Number(await page.getByTestId('cell-time').getAttribute('max'));
  expect(at / duration).toBeCloseTo(0.5, 1);
  await page.getByTestId('plot-revolute').getByRole('button', { name: /\(°\)$/ }).click();
  const shown = await page.getByTestId('value-T_deg').getAttribute('data-value');
  const { axes } = await asked({ time_s: at });
  expect(Number(shown), 'the position at that time').toBeCloseTo((axes.find(({ name }) => name === 'T')!.position * 180) / Math.PI, 6);
  await page.getByTestId('plot-revolute').getByRole('button', { name: /^T\b/ }).click();
  await expect.poll(() => page.getByTestId('plot-revolute').getByRole('button', { name: /^T\b/ }).getAttribute('aria-pressed')).toBe('false');
  await page.getByTestId('plot-revolute').locator('.u-over').hover();
  await page.mouse.wheel(0, -200);
  await page.getByRole('button', { name: 'Fit time', exact: true }).click();
  await page.getByTestId('plot-revolute').getByRole('button', { name: /\(°\)$/ }).click();
});

test('files that have changed on disk are overwritten only after confirmation', async () => {
  const path = join(fixture.folder, 'mine.toml');
  const theirs = readFileSync(path, 'utf8').replace('-494', '-493');
  writeFileSync(path, theirs);
  await page.locator('summary', { hasText: 'LP1' }).click();
  await page.getByTestId('station-LP1-x').fill('-492');
  await page.getByTestId('station-LP1-x').press('Enter');
  await until('it can be kept', () => page.getByTestId('save').isEnabled());
  await page.getByTestId('save').click();
  await page.getByTestId('disk-conflict').waitFor();
  expect(unhandled(heard.splice(0))).toEqual([]);
  expect(readFileSync(path, 'utf8')).toBe(theirs);
  await page.getByTestId('disk-conflict-show').click();
  const difference = page.getByTestId('disk-conflict-difference');
  await difference.first().waitFor();
  await expect.poll(async () => [await difference.locator('.removed code').allTextContents(), await difference.locator('.added code').allTextContents()].map((lines) => lines.map((line) => /-49\d/.exec(line)?.[0]))).toEqual([['-493'], ['-492']]);
  await expect.poll(() => accessibilityViolations(page, '[data-testid=disk-conflict]')).toEqual([]);
  await page.getByRole('button', { name: 'Reload from disk' }).click();
  await until('theirs is here', async () => (await page.getByTestId('station-LP1-x').inputValue()) === '-493');
  await page.getByRole('button', { name: 'Undo' }).click();
  await until('mine can be had back', async () => (await page.getByTestId('station-LP1-x').inputValue()) === '-492');
  writeFileSync(path, theirs.replace('-493', '-491'));
  await page.getByTestId('save').click();
  await page.getByTestId('disk-conflict').waitFor();
  expect(unhandled(heard.splice(0))).toEqual([]);
  await page.getByRole('button', { name: 'Overwrite' }).click();
  await until('mine is kept', async () => readFileSync(path, 'utf8').includes('-492'));
  await checkResult('passed');
});

test('the robot view is available next to the cell view', async () => {
  await page.getByRole('button', { name: 'Robot', exact: true }).first().click();
  await until('the robot is drawn', () => page.evaluate(() => window.jointplay.probe.frames > 0));
  await page.getByRole('button', { name: 'Cell', exact: true }).click();
  await checkResult('passed');
});

test('an invalid cell is opened, its error is marked, and it is fixed', async () => {
  writeFileSync(join(fixture.folder, 'steep.toml'), EXAMPLE_CELL.replace('angle_deg = 0.8', 'angle_deg = 2.0'));
  writeFileSync(join(fixture.folder, 'steep.program'), SHORT_PROGRAM);
  const other = await serve(0, ['--cell', join(fixture.folder, 'steep.toml')]);
  const second = await page.context().newPage();
  const messages = complaints(second);
  try {
    await load(second, other.address);
    await second.getByTestId('diagnostics').getByText('tilts 2.000°').waitFor();
    await second.getByText('Fix the errors in the cell file to display the cell.').waitFor();
    await expect.poll(() => second.getByText('The cell has no stations.').count()).toBe(0);
    for (const part of ['The virtualizations are', 'Stations are']) await second.getByText(`${part} unavailable: fix the errors in the cell file first.`).waitFor();
    const line = EXAMPLE_CELL.split('\n').findIndex((text) => text.startsWith('tilt = {')) + 1;
    await second.getByTestId('diagnostics').getByRole('button', { name: `cell, line ${line}, column 8` }).click();
    await second.getByTestId('text-cell').locator('.cm-content').click();
    await second.keyboard.press('Control+a');
    await second.keyboard.insertText(EXAMPLE_CELL);
    await until('it passes', async () => (await second.getByTestId('check-result').getAttribute('data-state')) === 'passed');
    await until('it is drawn', async () => (await partNames(second)).length > 0);
    await second.getByTestId('save').click();
    await until('it is saved', () => second.getByTestId('save').isDisabled());
    expect(readFileSync(join(fixture.folder, 'steep.toml'), 'utf8')).toBe(EXAMPLE_CELL);
    expect(messages).toEqual([]);
  } finally {
    await second.close();
    await other.stop();
  }
});

for (const [theme, tab] of [['light', 'Program'], ['light', 'Parts'], ['dark', 'Cell file'], ['dark', 'Steps']] as const)
  test(`no accessibility violations, ${theme} theme, tab ${tab}`, async () => {
    await page.getByLabel('Theme').selectOption(theme);
    await page.getByRole('tab', { name: tab }).click();
    await expect.poll(() => accessibilityViolations(page)).toEqual([]);
  });
