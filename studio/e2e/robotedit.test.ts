// Editing of the robot: fields, text, errors, undo, saving; comparison of models, own plots, values and layouts.

import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import type { Browser, Page } from 'playwright-core';
import { afterAll, afterEach, beforeAll, beforeEach, expect, test } from 'vitest';
import { ROOT, accessibilityViolations, browse, bytesOf, complaints, drawn, frames, load, reload, serve, unhandled, until, visit, type Server } from './studio';

const PAPER = readFileSync(resolve(ROOT, 'crates/jointplay-format/robots/gpr.toml'), 'utf8');
/** A robot as a stranger writes it: a parameter, comments, inline tables, rods away from their sockets. */
const STRANGE = `kind = 'gpr'
name = "test bench 3" # ours
limb = [
  { socket_radius_mm = 'r', socket_angle_deg = 0 }, # motor side
  { socket_radius_mm = 'r', socket_angle_deg = 90 },
  { socket_radius_mm = 120.5, socket_angle_deg = 225, base_point_mm = [-85, -85.5] },
]
limits = { rod_mm = [ 200, 300 ], tilt_deg = 2 }
working.height_mm = 250 # middle
[parameters]
r = 80 # as ordered
`;

let browser: Browser;
let folder: string;
let file: string;
let server: Server;
let page: Page;
let heard: string[];

beforeAll(async () => {
  browser = await browse();
  folder = mkdtempSync(join(tmpdir(), 'studio-'));
  file = join(folder, 'mine.toml');
});
afterAll(async () => {
  await browser?.close();
  rmSync(folder, { recursive: true });
});
beforeEach(async () => {
  writeFileSync(file, PAPER);
  server = await serve(0, ['--robot', file]);
  page = await visit(browser, { viewport: { width: 1440, height: 900 } });
  heard = complaints(page);
  await load(page, server.address);
  await drawn(page);
});
afterEach(async () => {
  await page.context().close();
  await server.stop();
  // The server refuses outdated versions.
  expect(unhandled(heard)).toEqual([]);
});

const text = () => page.getByTestId('text-robot').locator('.cm-content').innerText();
const edit = async () => {
  await page.getByTestId('edit-robot').click();
  await page.getByTestId('text-robot').locator('.cm-content').waitFor();
  await until('the fields are current', async () => !(await page.getByTestId('robot-fields').getAttribute('class'))?.includes('outdated'));
};
async function type(testid: string, value: string): Promise<void> {
  await page.getByTestId(testid).fill(value);
  await page.getByTestId(testid).press('Enter');
}
const holds = (part: string, present = true) => until(`the text ${present ? 'has' : 'lacks'} ${part}`, async () => (await text()).includes(part) === present);
const saved = () => until('it is saved', () => page.getByTestId('robot-save').isDisabled());

test('a number changes robot, text and pose at once; comments remain, undo restores, and the file is saved', async () => {
  const before = await page.evaluate(() => window.jointplay.probe.pose!.models[0]!.answer!.displacement_m);
  await edit();
  await type('field-socket-radius', '2 * 60');
  await holds('socket_radius_mm = 120.0');
  await expect.poll(async () => (await text()).match(/socket_radius_mm = 120\.0/g)).toHaveLength(3);
  await expect.poll(() => text()).toContain('# The span of 508 mm');
  // The displacement for a tilt is in proportion to the radius.
  await drawn(page, `Math.abs(pose.models[0].answer.displacement_m / ${before} - 120 / 93.218) < 1e-3`);
  await type('field-robot-ball_clearance', '20 µm');
  await holds('[ball]\nclearance_radius_um = 20.0');
  await until('the clearance is compared', async () => ((await page.getByTestId('needed-clearance').textContent()) ?? '').includes('clearance is sufficient'));
  await type('field-robot-ball_clearance', '0.005');
  await until('it is too small', async () => ((await page.getByTestId('needed-clearance').textContent()) ?? '').includes('too small'));
  await page.getByRole('button', { name: 'Undo' }).click();
  await holds('clearance_radius_um = 20.0');
  await page.getByRole('button', { name: 'Undo' }).click();
  await holds('[ball]', false);
  await page.getByRole('button', { name: 'Undo' }).click();
  await holds('socket_radius_mm = 93.218');
  await drawn(page, `Math.abs(pose.models[0].answer.displacement_m - ${before}) < 1e-12`);
  await expect.poll(() => page.getByTestId('robot-save').isDisabled()).toBe(true);
  await page.getByRole('button', { name: 'Redo' }).click();
  await holds('socket_radius_mm = 120.0');
  expect(readFileSync(file, 'utf8')).toBe(PAPER);
  await page.getByTestId('robot-save').click();
  await saved();
  expect(readFileSync(file, 'utf8')).toBe(PAPER.replaceAll('93.218', '120.0'));
});

test('a file with the line ends of Windows keeps them when it is edited', async () => {
  writeFileSync(file, PAPER.replaceAll('\n', '\r\n'));
  await edit();
  await page.keyboard.press('Control+o');
  await page.getByTestId('open-server').click();
  await page.locator('dialog[open]').waitFor({ state: 'hidden' });
  const content = page.getByTestId('text-robot').locator('.cm-content');
  await content.click();
  await page.keyboard.press('Control+End');
  await page.keyboard.insertText('# mine\n');
  await type('field-robot-tilt_limit', '1.25');
  await holds('tilt_deg = 1.25');
  await page.getByTestId('robot-save').click();
  await saved();
  expect(readFileSync(file, 'utf8')).toBe(`${PAPER.replace('tilt_deg = 1.5', 'tilt_deg = 1.25')}# mine\n`.replaceAll('\n', '\r\n'));
});

for (const { end, wait } of [
  { end: 'is loaded before its dialog closes', wait: () => page.locator('dialog[open]').waitFor({ state: 'hidden' }) },
  { end: 'is not opened once its dialog is closed', wait: () => page.keyboard.press('Escape') },
])
  test(`the robot of the server ${end}, so that no later edit is replaced`, async () => {
    await edit();
    await page.route('**/api/v1/robot/file', async (route) => {
      await new Promise((delay) => setTimeout(delay, 1000));
      await route.fallback();
    });
    const loaded = page.waitForResponse('**/api/v1/robot/file');
    await page.keyboard.press('Control+o');
    await page.getByTestId('open-server').click();
    await wait();
    await type('field-robot-tilt_limit', '1.25');
    await loaded;
    await frames(page);
    await holds('tilt_deg = 1.25');
  });

test('another robot is opened at its working height, and undo returns to the pose before', async () => {
  await edit();
  const height = () => page.getByTestId('field-height').inputValue();
  await type('field-height', '510');
  await open('bench.toml', STRANGE);
  await until('its working height', async () => (await height()) === '250');
  await undo();
  await until('the pose before', async () => (await height()) === '510');
});

test('errors of the text are reported at their lines, and the last robot without errors remains', async () => {
  await edit();
  const content = page.getByTestId('text-robot').locator('.cm-content');
  await content.click();
  await page.keyboard.press('Control+End');
  await page.keyboard.insertText('[limit]\ntilt_deg = 3\n');
  await page.getByTestId('robot-diagnostics').filter({ hasText: 'did you mean `limits`?' }).waitFor();
  await page.getByTestId('robot-diagnostics').filter({ hasText: 'last robot without errors' }).waitFor();
  await until('it is underlined', async () => (await page.getByTestId('text-robot').locator('.cm-lintRange-error').count()) > 0);
  // Save writes the text as it is.
  await page.keyboard.press('Control+s');
  await saved();
  expect(readFileSync(file, 'utf8')).toBe(`${PAPER}[limit]\ntilt_deg = 3\n`);
  await page.keyboard.press('Control+z');
  await until('there are no errors', async () => (await page.getByTestId('robot-diagnostics').count()) === 0);
  // A limit by which the working height is invalid has the line of the height.
  await type('field-robot-rod_min', '600');
  await page.getByTestId('robot-diagnostics').filter({ hasText: 'line 32' }).waitFor();
  await type('field-robot-rod_min', '300');
  await until('there are no errors', async () => (await page.getByTestId('robot-diagnostics').count()) === 0);
  // A smaller limit of the tilt moves the robot to it.
  await type('field-robot-tilt_limit', '0.5');
  await drawn(page, 'Math.abs(pose.tilt.angle_rad - Math.PI / 360) < 1e-9');
  await page.getByRole('alert').filter({ hasText: 'Held by a limit: the tilt is' }).waitFor();
});

test('a file that changed on disk is not overwritten unseen', async () => {
  await edit();
  await type('limb-2-angle', '125');
  await holds('socket_angle_deg = 125.0');
  writeFileSync(file, `${PAPER}# another editor\n`);
  await page.getByTestId('robot-save').click();
  await page.getByTestId('robot-conflict').waitFor();
  expect(readFileSync(file, 'utf8')).toContain('# another editor');
  await page.getByTestId('robot-conflict-show').click();
  await page.getByTestId('robot-conflict-difference').locator('.removed').filter({ hasText: '# another editor' }).waitFor();
  await page.getByTestId('robot-conflict-difference').locator('.added').filter({ hasText: 'socket_angle_deg = 125.0' }).waitFor();
  await page.getByRole('button', { name: 'Reload from disk' }).click();
  await holds('# another editor');
  await expect.poll(() => text()).toContain('socket_angle_deg = 120.0');
  // The numbers follow the text once the server has read it.
  await until('the number of the file', async () => (await page.getByTestId('limb-2-angle').inputValue()) === '120');
  await type('limb-2-angle', '');
  await page.getByRole('alert').filter({ hasText: 'an angle is missing' }).waitFor();
  await expect.poll(() => page.getByTestId('limb-2-angle').inputValue()).toBe('120');
});

/** Opens a robot in the dialog *Open*. */
async function open(name: string, robot: string): Promise<void> {
  await page.keyboard.press('Control+o');
  await page.getByTestId('open-file').setInputFiles({ name, mimeType: 'text/plain', buffer: Buffer.from(robot) });
  await until('it is open', async () => (await fileName()).startsWith(name));
}
const fileName = async () => (await page.getByTestId('robot-editor').locator('h2 .soft').textContent()) ?? '';
const undo = () => page.getByRole('button', { name: 'Undo' }).click();

test('undo after opening another robot returns to the file of the server, its parameters and its unsaved changes', async () => {
  await page.goto('about:blank');
  await server.stop();
  writeFileSync(file, STRANGE);
  server = await serve(0, ['--robot', file, '--set', 'r=85']);
  await load(page, server.address);
  await drawn(page);
  await edit();
  await type('limb-3-x', '-86');
  await holds('[-86.0, -85.5]');
  await open('paper.toml', PAPER);
  await holds('socket_radius_mm = 93.218');
  await expect.poll(() => page.getByTestId('robot-save').count()).toBe(0);
  await expect.poll(() => fileName()).toBe('paper.toml');
  await type('field-socket-radius', '100');
  await holds('socket_radius_mm = 100.0');
  await undo();
  await holds('socket_radius_mm = 93.218');
  await expect.poll(() => fileName()).toBe('paper.toml');
  await undo();
  await holds('[-86.0, -85.5]');
  await until('the name is restored', async () => (await fileName()) === 'mine.toml: unsaved changes');
  await expect.poll(() => page.getByTestId('parameter-r').inputValue()).toBe('85');
  await until('the radius is that of the parameter', async () => (await page.getByTestId('limb-1-radius').inputValue()) === '85');
  await page.getByTestId('robot-save').click();
  await saved();
  expect(readFileSync(file, 'utf8')).toBe(STRANGE.replace('[-85,', '[-86.0,'));
  // Redo opens the other robot again, which is no change of the file of the server.
  await page.getByRole('button', { name: 'Redo' }).click();
  await until('the other robot is open', async () => (await fileName()) === 'paper.toml');
  await undo();
  await until('the saved file is shown', async () => (await fileName()) === 'mine.toml');
});

test('changes of fields are made after a reconnection, as an undo step', async () => {
  await edit();
  await type('limb-2-angle', '125');
  await holds('socket_angle_deg = 125.0');
  await page.route('**/api/v1/**', (route) => route.abort());
  await type('field-socket-radius', '120');
  await page.getByTestId('disconnected').waitFor();
  await type('field-robot-tilt_limit', '1');
  await expect.poll(() => text()).toContain('socket_radius_mm = 93.218');
  await page.unroute('**/api/v1/**');
  await holds('socket_radius_mm = 120.0');
  await holds('tilt_deg = 1.0');
  await expect.poll(async () => (await text()).match(/socket_radius_mm = 120\.0/g)).toHaveLength(3);
  await undo();
  await holds('socket_radius_mm = 93.218');
  await expect.poll(() => text()).toContain('socket_angle_deg = 125.0');
  expect(heard.splice(0).filter((line) => !line.includes('ERR_FAILED'))).toEqual([]);
});

test('expressions are shown and not overwritten; parameters change what depends on them', async () => {
  // The page would ask the stopped server.
  await page.goto('about:blank');
  await server.stop();
  writeFileSync(file, STRANGE);
  server = await serve(0, ['--robot', file, '--set', 'r=85']);
  await load(page, server.address);
  await drawn(page);
  await edit();
  await expect.poll(() => page.getByTestId('limb-1-radius').isDisabled()).toBe(true);
  await expect.poll(() => page.getByTestId('limb-1-radius').inputValue()).toBe('85');
  await expect.poll(() => page.getByTestId('parameter-r').inputValue()).toBe('85');
  await expect.poll(() => page.getByTestId('limb-3-radius').isDisabled()).toBe(false);
  await type('parameter-r', '90');
  await holds('r = 90.0 # as ordered');
  await until('the radius follows', async () => (await page.getByTestId('limb-1-radius').inputValue()) === '90');
  await type('limb-3-x', '-86');
  await holds('[-86.0, -85.5]');
  await page.getByTestId('robot-save').click();
  await saved();
  expect(readFileSync(file, 'utf8')).toBe(STRANGE.replace('r = 80', 'r = 90.0').replace('[-85,', '[-86.0,'));
});

test('a motion is compared under several models, plotted as the user wants, and the layout is saved', async () => {
  await page.getByTestId('figure').selectOption('6');
  const count = (of: number) => until(`${of} samples`, async () => (await page.getByTestId('sample').getAttribute('data-count')) === String(of));
  await count(777);
  await page.getByTestId('all-plots').click();
  await page.getByTestId('plot-menu').click();
  await page.getByTestId('compare-planar').check();
  await page.getByTestId('plot-shown-displacement').check();
  await page.getByTestId('plot-shown-linear').uncheck();
  await page.getByTestId('own-y-planar:torsion_rad').check();
  await page.getByTestId('own-x').selectOption('tilt_rad');
  await expect.poll(() => page.getByTestId('own-y-q1_m').isDisabled(), { message: 'another unit' }).toBe(true);
  await page.getByTestId('own-unit').selectOption('mrad');
  await page.getByTestId('own-add').click();
  await page.getByTestId('layout-name').fill('two models');
  await page.getByTestId('layout-save').click();
  await expect.poll(() => accessibilityViolations(page)).toEqual([]);
  await page.getByTestId('plot-menu-close').click();
  await page.getByTestId('plot-own-1').waitFor();
  await expect.poll(() => page.getByTestId('plot-linear').count()).toBe(0);
  const names = () => page.getByTestId('plot-displacement').locator('.legend').allTextContents();
  await until('both models are plotted', async () => (await names()).length === 2);
  await expect.poll(async () => (await names()).map((name) => name.trim().split(' ')[0])).toEqual(['polar', 'planar']);

  // Values at two samples and their difference are those of the poses.
  const displacement = () => page.evaluate(() => window.jointplay.probe.pose!.models.find(({ model }) => model.virtualization === 'planar')!.answer!.displacement_m);
  await page.getByTestId('scrub').fill('12');
  await drawn(page, 'Math.abs(pose.tilt.angle_rad - 0.4 * Math.PI / 180) < 1e-9');
  const first = await displacement();
  await page.locator('body').press('c');
  await page.getByTestId('show-values').click();
  await page.getByTestId('scrub').fill('20');
  await drawn(page, 'Math.abs(pose.tilt.angle_rad - 2 * Math.PI / 180) < 1e-9');
  const second = await displacement();
  const shown = Number(await page.getByTestId('difference-displacement planar:displacement_m').getAttribute('data-value'));
  expect(shown).toBeCloseTo((second - first) * 1e6, 9);

  await page.getByTestId('export').click();
  const [figure] = await Promise.all([page.waitForEvent('download'), page.getByTestId('export-svg').click()]);
  const svg = (await bytesOf(figure)).toString('utf8');
  expect(svg).toContain('tilt angle α [°]');
  expect(svg).toContain('planar ‖ΔX‖');

  // The plots remain; a changed layout is restored by its name.
  await reload(page);
  await count(777);
  await page.getByTestId('plot-own-1').waitFor();
  await page.getByTestId('plot-menu').click();
  await page.getByTestId('plot-shown-linear').check();
  await page.getByRole('button', { name: 'Remove the plot of' }).click();
  await page.getByTestId('layout-two models').click();
  await page.getByTestId('plot-menu-close').click();
  await page.getByTestId('plot-own-1').waitFor();
  await expect.poll(() => page.getByTestId('plot-linear').count()).toBe(0);
});

test('a point of a plot of two quantities is a sample', async () => {
  await page.addInitScript(() => localStorage.setItem('jointplay.studio.plots.own', JSON.stringify([{ id: 'own-1', x: 'q1_m', y: ['q2_m', 'q3_m'], unit: 'mm' }])));
  await reload(page);
  await page.getByTestId('motion').selectOption('raster');
  await until('777 samples', async () => (await page.getByTestId('sample').getAttribute('data-count')) === '777');
  const canvas = page.getByTestId('plot-own-1').locator('canvas');
  const box = (await canvas.boundingBox())!;
  await canvas.click({ position: { x: box.width - 20, y: box.height / 2 } });
  // Far at the right the first rod is longest.
  await drawn(page, 'pose.rods_m[0] > pose.rods_m[1] && pose.rods_m[0] > pose.rods_m[2] && pose.tilt.angle_rad > 0.03');
});

test('a rod moves along the limit of the tilt, and back', async () => {
  await page.getByRole('button', { name: 'Level', exact: true }).click();
  await drawn(page, 'pose.tilt.angle_rad < 1e-9');
  await page.getByRole('tab', { name: 'Rods' }).click();
  await type('field-rod-1', '510');
  await drawn(page, 'Math.abs(pose.tilt.angle_rad - 1.5 * Math.PI / 180) < 1e-9 && Math.abs(pose.rods_m[0] + pose.rods_m[1] + pose.rods_m[2] - 1.51) < 1e-9');
  await page.getByRole('alert').filter({ hasText: 'Held by a limit: the tilt is' }).waitFor();
  await page.getByRole('button', { name: 'Level', exact: true }).click();
  await drawn(page, 'pose.tilt.angle_rad < 1e-9');
  await page.getByRole('tab', { name: 'Rods' }).click();
  // In one drag the other rods come back to where they were.
  const height = await page.evaluate(() => window.jointplay.probe.pose!.axis_height_m);
  const slider = page.getByTestId('slider-rod-1');
  const box = (await slider.boundingBox())!;
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width - 2, box.y + box.height / 2, { steps: 6 });
  await drawn(page, `pose.axis_height_m > ${height} + 0.001 && pose.stopped_by.length === 1`);
  await page.mouse.move(box.x + box.width / 2 + 1, box.y + box.height / 2, { steps: 6 });
  await drawn(page, `Math.abs(pose.axis_height_m - ${height}) < 1e-4 && pose.stopped_by.length === 0`);
  await page.mouse.up();
});

test('pictures have vector labels and axes', async () => {
  await page.getByTestId('export').click();
  await page.getByTestId('picture-size').selectOption('slide');
  const [download] = await Promise.all([page.waitForEvent('download'), page.getByTestId('export-vectors').click()]);
  const svg = (await bytesOf(download)).toString('utf8');
  expect(svg).toContain('width="254mm" height="142.88mm"');
  expect(svg).toContain('href="data:image/png;base64,iVBOR');
  // The labels of the virtual joints, with subscripts, and those of the axes.
  expect(svg).toMatch(/<text[^>]*>l<\/text>\n<text[^>]*>1<\/text>/);
  expect(svg).toMatch(/<text[^>]*>x<\/text>/);
  // Six arrows of two frames, each a line and a head.
  expect(svg.match(/<path d="M[^"]*" fill="#/g)).toHaveLength(6);
  expect(svg).toContain('Play scale 500× · polar');
});

for (const theme of ['light', 'dark'])
  test(`the editor of the robot is accessible, ${theme}`, async () => {
    await page.getByLabel('Theme').selectOption(theme);
    await edit();
    await page.getByTestId('figure').selectOption('6');
    await page.getByTestId('all-plots').click();
    await page.getByTestId('show-values').click();
    await expect.poll(() => accessibilityViolations(page)).toEqual([]);
  });

for (const [width, height] of [[390, 844], [720, 450], [1024, 700], [1440, 900], [1920, 1080]] as const)
  test(`the editor fits in a window of ${width} × ${height}`, async () => {
    await page.setViewportSize({ width, height });
    await edit();
    const editor = (await page.getByTestId('robot-editor').boundingBox())!;
    expect(editor.width).toBeGreaterThanOrEqual(Math.min(width, 380) - 1);
    expect(editor.x + editor.width).toBeLessThanOrEqual(width);
    await page.getByTestId('text-robot').scrollIntoViewIfNeeded();
    const box = (await page.getByTestId('text-robot').boundingBox())!;
    expect(Math.min(box.width, box.height)).toBeGreaterThan(120);
    const scene = (await page.locator('.scene').boundingBox())!;
    expect(scene.width).toBeGreaterThanOrEqual(240);
    for (const name of ['slider-socket-radius', 'limb-3-y', 'field-robot-tilt_limit']) {
      await page.getByTestId(name).scrollIntoViewIfNeeded();
      const one = (await page.getByTestId(name).boundingBox())!;
      expect(one.width, name).toBeGreaterThan(40);
      expect(one.x + one.width, name).toBeLessThanOrEqual(editor.x + editor.width);
    }
  });

test('an unsaved text survives a reload, and is restored or discarded', async () => {
  page.on('dialog', (dialog) => void dialog.accept());
  const draft = page.getByTestId('robot-draft');
  await expect.poll(() => draft.count()).toBe(0);
  await edit();
  await type('field-socket-radius', '101.5');
  await holds('socket_radius_mm = 101.5');
  await reload(page);
  await draft.filter({ hasText: 'unsaved changes to mine.toml' }).waitFor();
  expect(readFileSync(file, 'utf8')).toBe(PAPER);
  // New edits do not replace it.
  await edit();
  await type('field-socket-radius', '102.5');
  await holds('socket_radius_mm = 102.5');
  await draft.getByRole('button', { name: 'Restore' }).click();
  await holds('socket_radius_mm = 101.5');
  await expect.poll(() => draft.count()).toBe(0);
  await page.keyboard.press('Escape');
  await page.getByTestId('robot-save').click();
  await saved();
  expect(readFileSync(file, 'utf8')).toContain('socket_radius_mm = 101.5');
  await reload(page);
  await drawn(page);
  await expect.poll(() => draft.count(), { message: 'a saved text is no draft' }).toBe(0);
  await edit();
  await type('field-socket-radius', '103.5');
  await holds('socket_radius_mm = 103.5');
  await reload(page);
  await draft.getByRole('button', { name: 'Discard' }).click();
  await reload(page);
  await drawn(page);
  await expect.poll(() => draft.count()).toBe(0);
});

for (const [size, times] of [['1 mm', 0.005], ['10 m', 45]] as const)
  test(`a robot of ${size} fills the view as the paper’s does`, async () => {
    const scaled = PAPER.replace(/(socket_radius_mm|height_mm|clearance_radius_um) = ([\d.]+)/g, (_, key, value) => `${key} = ${Number(value) * times}`).replace(/rod_mm = \[([^\]]*)\]/, (_, limits) => `rod_mm = [${(limits as string).split(',').map((limit) => Number(limit) * times).join(', ')}]`);
    const width = async () => {
      const x = (await page.evaluate(() => window.jointplay.probe.platform!())).map((point) => point.x);
      return Math.max(...x) - Math.min(...x);
    };
    const before = await width();
    writeFileSync(file, scaled);
    // The open page would report that its server is away.
    await page.goto('about:blank');
    await server.stop();
    server = await serve(0, ['--robot', file]);
    await load(page, server.address);
    await drawn(page);
    await expect.poll(async () => Math.abs((await width()) / before - 1)).toBeLessThan(0.5);
  });
