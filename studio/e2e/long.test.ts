// Long programs: kinematics of the page compared with the server, transferred data, and display while loading.

import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import type { Browser, Page, Route } from 'playwright-core';
import { afterAll, beforeAll, expect, test } from 'vitest';
import { frames, type Frame } from '../src/lib/kinematics';
import { MotionWindow, type WaferPlacement } from '../src/lib/motion';
import { ROOT, browse, complaints, load, serve, until, type Server } from './studio';

const CELL = readFileSync(resolve(ROOT, 'crates/jointplay-format/cells/example.toml'), 'utf8');
const LINES = 2000;
const PROGRAM = 'HOME\n' + Array.from({ length: LINES }, (_, k) => (k % 2 ? 'TRANSFER LP2 SLOT 1 TO LP1 SLOT 1 WITH A\n' : 'TRANSFER LP1 SLOT 1 TO LP2 SLOT 1 WITH A\n')).join('');

let browser: Browser;
let server: Server;
let folder: string;

beforeAll(async () => {
  folder = mkdtempSync(join(tmpdir(), 'studio-'));
  writeFileSync(join(folder, 'long.toml'), CELL);
  writeFileSync(join(folder, 'long.program'), PROGRAM);
  [browser, server] = await Promise.all([browse(), serve(0, ['--cell', join(folder, 'long.toml')])]);
});
afterAll(async () => {
  await browser?.close();
  await server?.stop();
  rmSync(folder, { recursive: true });
});

async function ask(path: string, body?: object): Promise<Response> {
  const answer = await fetch(`${server.address}api/v1/${path}`, body ? { method: 'POST', headers: { 'content-type': 'application/json' }, body: JSON.stringify(body) } : {});
  expect(answer.status, path).toBe(200);
  return answer;
}

/** The same numbers in each run. */
function* shares(): Generator<number, never> {
  for (let state = 1; ; ) {
    state = (state * 48271) % 2147483647;
    yield state / 2147483647;
  }
}

/** Another robot in the cell, and another program for it where it has other effectors. */
const ROBOTS: [string, (text: string) => string, string][] = [
  ['two arms', (text) => text, 'BLEND 20 mm\nHOME\nTRANSFER LP1 SLOT 1 TO PM1 WITH A\nTRANSFER PM1 TO LP2 SLOT 25 WITH B\nTRANSFER LP1 SLOT 2 TO ALIGN WITH A\nHOME\n'],
];

for (const [name, change, program] of ROBOTS)
  test(`the kinematics of the page equals that of the server: ${name}`, async () => {
    const plan = (await (await ask('cell/plan', { cell: change(CELL), program })).json()) as never as {
      key: string;
      windows: { key: string; start_s: number }[];
      chain: Parameters<typeof frames>[0];
      robot: { axes: { name: string }[]; arms: { links: string[] }[] };
      wafers: { name: string; held: Omit<WaferPlacement, 'wafer'> }[];
      report: { duration_s: number };
    };
    const windows = await Promise.all(plan.windows.map(async ({ key }) => new MotionWindow(await (await ask(`cell/windows/${key}`)).arrayBuffer())));
    const names = { axes: plan.robot.axes.map(({ name }) => name), links: plan.robot.arms.map(({ links }) => links), wafers: plan.wafers.map(({ name }) => name) };
    const random = shares();
    let worst = 0;
    for (let look = 0; look < 200; look += 1) {
      const time_s = random.next().value * plan.report.duration_s;
      const at = plan.windows.filter(({ start_s }) => start_s <= time_s).length - 1;
      const window = windows[at]!;
      const step = window.stepAt(time_s - plan.windows[at]!.start_s);
      const since = time_s - plan.windows[at]!.start_s - window.steps[step]!.start_s;
      const held = window.held(plan.wafers.map(({ held }, wafer) => ({ wafer, ...held })), step);
      const mine = frames(plan.chain, names, window.values(step, since), held);
      const { frames: theirs } = (await (await ask('cell/jog', { plan: plan.key, time_s })).json()) as { frames: Frame[] };
      expect(mine.map(({ name }) => name)).toEqual(theirs.map(({ name }) => name));
      mine.forEach(({ origin_m, quaternion }, k) => {
        const other = theirs[k]!;
        const same = quaternion.reduce((sum, part, i) => sum + part * other.quaternion[i]!, 0) < 0 ? -1 : 1;
        const off = Math.max(Math.hypot(...origin_m.map((part, i) => part - other.origin_m[i]!)), Math.hypot(...quaternion.map((part, i) => part - same * other.quaternion[i]!)));
        worst = Math.max(worst, off);
      });
    }
    expect(worst).toBeGreaterThan(0);
    expect(worst).toBeLessThan(1e-6);
  });

const planned = async (page: Page) => (await page.getByTestId('planned').textContent())!.startsWith('Planned');
const sound = async (page: Page) => (await page.getByTestId('check-result').getAttribute('data-state')) === 'passed';

test('an edit of a long program transfers only changed data', async () => {
  const page = await (await browser.newContext({ viewport: { width: 1280, height: 720 }, reducedMotion: 'reduce' })).newPage();
  const heard = complaints(page);
  let bytes = 0;
  const seen: string[] = [];
  page.on('requestfinished', (request) => {
    if (!request.url().includes('/api/')) return;
    seen.push(request.url());
    void request.sizes().then(({ requestBodySize, responseBodySize }) => (bytes += requestBodySize + responseBodySize));
  });
  await load(page, server.address);
  await until('it is sound', () => sound(page));
  await until('it is drawn', () => page.evaluate(() => (window.jointplay.probe.cell?.parts().length ?? 0) > 0 && window.jointplay.probe.cellFrames > 0));
  await until('all of it is there', async () => (await planned(page)) && (await page.getByTestId('loading').count()) === 0);
  // A moment far into it.
  const link = () => page.evaluate(() => window.jointplay.probe.cell!.origin('upper link 4'));
  const home = await link();
  const middle = Number(await page.getByTestId('cell-time').getAttribute('max')) / 2 + 3;
  await page.getByTestId('cell-time').fill(String(middle));
  await until('that is shown', async () => (await page.getByTestId('loading').count()) === 0 && JSON.stringify(await link()) !== JSON.stringify(home));
  await expect.poll(() => page.getByTestId('cell-step').textContent()).toMatch(/^line \d{3,4}: /);
  // One line more at the end.
  await page.getByTestId('text-program').locator('.cm-content').click();
  await page.keyboard.press('Control+End');
  await until('no plan is running', async () => planned(page));
  const before = await page.getByTestId('cell-time').getAttribute('max');
  bytes = 0;
  seen.length = 0;
  await page.keyboard.insertText('WAIT 3 s\n');
  await until('it is planned', async () => (await page.getByTestId('cell-time').getAttribute('max')) !== before && (await planned(page)));
  await until('its motion is there', async () => (await page.getByTestId('loading').count()) === 0);
  expect(seen.some((url) => url.endsWith('/cell/plan'))).toBe(true);
  expect(seen.filter((url) => url.includes('/cell/scenes/')), 'the cell is the same').toEqual([]);
  expect(bytes).toBeGreaterThan(0);
  expect(bytes, seen.join(' ')).toBeLessThan(150_000);
  expect(heard).toEqual([]);
  await page.close();
});

test('the page shows that a part of the motion is loading', async () => {
  const page = await (await browser.newContext({ viewport: { width: 1280, height: 720 }, reducedMotion: 'reduce' })).newPage();
  await load(page, server.address);
  await until('it is sound', () => sound(page));
  await until('all of it is there', async () => (await planned(page)) && (await page.getByTestId('loading').count()) === 0);
  const waiting: Route[] = [];
  let held = true;
  await page.route('**/cell/windows/*', (route) => void (held ? waiting.push(route) : route.continue()));
  await page.getByTestId('cell-time').fill('4321');
  await page.getByTestId('loading').filter({ hasText: 'Loading' }).waitFor();
  const link = () => page.evaluate(() => window.jointplay.probe.cell!.origin('upper link 4'));
  const shown = await link();
  await expect.poll(() => page.getByTestId('cell-step').textContent(), { message: 'no step is named' }).toBe('');
  await until('it is asked for', async () => waiting.length > 0);
  expect(await link(), 'no pose is made up').toEqual(shown);
  held = false;
  for (const route of waiting) await route.continue();
  await page.getByTestId('loading').waitFor({ state: 'detached' });
  await expect.poll(() => page.getByTestId('cell-step').textContent()).toMatch(/^line \d+: /);
  await page.close();
});
