import { execFileSync } from 'node:child_process';
import type { Browser, Page } from 'playwright-core';
import { afterAll, afterEach, beforeAll, expect, test } from 'vitest';
import { COMMAND, accessibilityViolations, browse, complaints, drawn, load, reload, serve, until, visit, type Server } from './studio';

const CLIPBOARD = { permissions: ['clipboard-read', 'clipboard-write'] };

let browser: Browser;
let server: Server;
let page: Page;
let heard: string[];

beforeAll(async () => {
  [browser, server] = await Promise.all([browse(), serve()]);
  page = await visit(browser, CLIPBOARD);
  heard = complaints(page);
  await load(page, server.address);
});
afterAll(async () => {
  await browser?.close();
  await server?.stop();
});
afterEach(() => {
  expect(heard.splice(0)).toEqual([]);
});

const USUAL = '#pose=tilt,0,1.5,500,axis&model=polar,newton,paper&play=500&show=joints,arrows,frames,labels';

let links = 0;
/** Follows a link within the page, without loading it again. */
async function open(hash = USUAL): Promise<void> {
  await drawn(page);
  links += 1;
  await page.evaluate(
    (to) =>
      new Promise((followed) => {
        window.addEventListener('hashchange', () => setTimeout(followed), { once: true });
        window.location.hash = to;
      }),
    `${hash}&n=${links}`,
  );
  await drawn(page, 'window.jointplay.probe.settled');
}

const field = (name: string) => page.getByTestId(`field-${name}`);
const value = async (name: string) => Number(await field(name).inputValue());

async function type(name: string, text: string): Promise<void> {
  await field(name).fill(text);
  await field(name).press('Enter');
}

test('the introduction is visible, and the values equal those of the command line', async () => {
  await open('#pose=rods,500,501,502&model=polar,newton,paper&play=500');
  await expect.poll(() => page.getByText('With ideal joints, this robot can only translate').isVisible()).toBe(true);
  const reported = JSON.parse(
    execFileSync(COMMAND, ['forward', '--q-mm', '500,501,502', '--virtualization', 'polar', '--solver', 'newton', '--format', 'json'], {
      encoding: 'utf8',
    }),
  );
  const joints = await page.getByTestId('joints').locator('[data-value]').all();
  const shown = await Promise.all(joints.map(async (joint) => Number(await joint.getAttribute('data-value'))));
  // Compared to the twelfth digit: the command prints mm and degrees.
  reported.virtual_joints.l_mm.forEach((mm: number, k: number) => expect(shown[k]! * 1e3).toBeCloseTo(mm, 10));
  reported.virtual_joints.phi_deg.forEach((deg: number, k: number) => expect((shown[3 + k]! * 180) / Math.PI).toBeCloseTo(deg, 10));
  const shift = page.getByTestId('shift-polar');
  await expect.poll(async () => Number(await shift.getAttribute('data-x')) * 1e3).toBeCloseTo(reported.platform.center_shift_mm[0], 10);
  await expect.poll(async () => Number(await shift.getAttribute('data-y')) * 1e3).toBeCloseTo(reported.platform.center_shift_mm[1], 10);
  await page.getByRole('tab', { name: 'Direction, angle' }).click();
  await expect.poll(() => value('azimuth')).toBeCloseTo(reported.platform.azimuth_deg, 3);
  await expect.poll(() => value('tilt')).toBeCloseTo(reported.platform.tilt_deg, 3);
});

test('each jog of the robot is one undo step', async () => {
  await open();
  await expect.poll(() => page.getByTestId('instantaneous').textContent()).toBe('1');
  await page.getByRole('button', { name: 'Level', exact: true }).click();
  await drawn(page, 'pose.tilt.angle_rad < 1e-9');
  await expect.poll(() => page.getByTestId('instantaneous').textContent()).toBe('3');
  await expect.poll(() => page.getByTestId('finite').textContent()).toBe('1');
  await expect.poll(() => page.getByTestId('rank').textContent()).toBe('9');
  await type('height', '400');
  await drawn(page, 'Math.abs(pose.axis_height_m - 0.4) < 1e-9');
  await page.getByRole('button', { name: 'Increase Tilt angle α by 0.05 °' }).click();
  await drawn(page, 'Math.abs(pose.tilt.angle_rad - 0.05 * Math.PI / 180) < 1e-9');

  // A drag of a slider, however many moves it takes, is one step.
  const slider = (await page.getByTestId('slider-tilt').boundingBox())!;
  const middle = slider.y + slider.height / 2;
  await page.mouse.move(slider.x + slider.width / 2, middle);
  await page.mouse.down();
  for (const part of [0.55, 0.65, 0.75, 0.85]) await page.mouse.move(slider.x + slider.width * part, middle);
  await page.mouse.up();
  await drawn(page, 'pose.tilt.angle_rad > 0.01');

  await page.keyboard.press('Control+z');
  await drawn(page, 'Math.abs(pose.tilt.angle_rad - 0.05 * Math.PI / 180) < 1e-9');
  await page.keyboard.press('Control+z');
  await drawn(page, 'pose.tilt.angle_rad < 1e-9 && Math.abs(pose.axis_height_m - 0.4) < 1e-9');
  await page.keyboard.press('Control+z');
  await drawn(page, 'Math.abs(pose.axis_height_m - 0.5) < 1e-9');
  await page.keyboard.press('Control+Shift+z');
  await drawn(page, 'Math.abs(pose.axis_height_m - 0.4) < 1e-9');
});

test('the robot stops at limits or moves along them, with a message', async () => {
  await open();
  await type('tilt', '3');
  await expect.poll(() => page.getByText('Tilt angle α ranges from -1.5 to 1.5 °').isVisible()).toBe(true);
  // One rod alone tilts the platform: beyond the limit of tilt the others follow, as little as possible.
  await open('#pose=rods,500,500,500');
  await type('rod-1', '520');
  await page.getByRole('alert').filter({ hasText: 'Held by a limit: the tilt is' }).waitFor();
  await drawn(page, 'Math.abs(pose.tilt.angle_rad - 1.5 * Math.PI / 180) < 1e-9 && Math.abs(pose.rods_m[0] + pose.rods_m[1] + pose.rods_m[2] - 1.52) < 1e-9');
  const stopped = await value('rod-1');
  expect(stopped).toBeGreaterThan(503);
  expect(stopped).toBeLessThan(510);
  // There it can go on: back, and undone.
  await type('rod-1', '502');
  await drawn(page, 'Math.abs(pose.rods_m[0] - 0.502) < 1e-9');
  await expect.poll(() => page.getByRole('alert').count()).toBe(0);
  await page.keyboard.press('Control+z');
  await drawn(page, 'Math.abs(pose.tilt.angle_rad - 1.5 * Math.PI / 180) < 1e-9');
  // Two limits together: high up there is no room to tilt.
  await open('#pose=tilt,90,-0.5,740,axis');
  await type('height', '754');
  await page.getByRole('alert').filter({ hasText: 'Stopped at a limit: rod' }).waitFor();
  await drawn(page, 'pose.axis_height_m > 0.745 && Math.max(...pose.rods_m) < 0.754 + 1e-9');
  await expect.poll(() => value('azimuth')).toBeCloseTo(90, 3);
  await expect.poll(() => value('tilt')).toBeCloseTo(-0.5, 3);
});

test('the initial pose is within the tilt limit, and jogging follows the limit', async () => {
  const fresh = await visit(browser);
  try {
    await load(fresh, server.address);
    await drawn(fresh, 'Math.abs(pose.tilt.angle_rad - Math.PI / 180) < 1e-9');
    await load(fresh, `${server.address}#pose=xy,0,1.5,500,axis`);
    await drawn(fresh, 'Math.abs(pose.tilt.about_y_rad - 1.5 * Math.PI / 180) < 1e-9');
    await fresh.keyboard.press('k');
    // Toward x by as much as the circle of the limit allows, and off y.
    await drawn(fresh, 'pose.tilt.about_x_rad > 1.7e-3 && Math.abs(pose.tilt.angle_rad - 1.5 * Math.PI / 180) < 1e-7');
    const tilt = await fresh.evaluate(() => window.jointplay.probe.pose!.tilt);
    expect(tilt.about_x_rad / tilt.about_y_rad).toBeCloseTo(0.1 / 1.5, 4);
    await fresh.keyboard.press('i');
    await drawn(fresh, 'Math.abs(pose.tilt.about_x_rad) < 1e-5');
  } finally {
    await fresh.context().close();
  }
});

test('button names are unique', async () => {
  await open();
  const names = await page.evaluate(() => [...document.querySelectorAll('main button')].map((one) => one.getAttribute('aria-label') ?? one.textContent!.trim()));
  expect(new Set(names).size).toBe(names.length);
  await page.getByLabel('Standard view').selectOption('front');
  await until('the view turns', () => page.evaluate(() => window.location.hash.includes('view=')));
});

test('the platform is dragged by its three handles', async () => {
  await open('#pose=xy,0,0,500,axis');
  await drawn(page, 'pose.tilt.angle_rad < 1e-9 && Math.abs(pose.axis_height_m - 0.5) < 1e-9');
  const canvas = page.locator('.scene canvas').first();
  // The handles are found as users find them: by the tooltip over them.
  const found = new Map(
    await canvas.evaluate((canvas) => {
      const seen = new Map<string, { x: number; y: number }>();
      const box = canvas.getBoundingClientRect();
      for (let y = box.top + 10; y < box.top + box.height * 0.6; y += 6)
        for (let x = box.left + 330; x < box.right - 100; x += 6) {
          canvas.dispatchEvent(new PointerEvent('pointermove', { clientX: x, clientY: y }));
          const tooltip = (canvas as HTMLElement).title;
          if (tooltip && !seen.has(tooltip)) seen.set(tooltip, { x, y });
        }
      return [...seen];
    }),
  );
  expect([...found.keys()].sort()).toEqual(['Drag: along z', 'Drag: tilt about x', 'Drag: tilt about y']);
  const drag = async (handle: string) => {
    const at = found.get(handle)!;
    await page.mouse.move(at.x, at.y);
    await page.mouse.down();
    await page.mouse.move(at.x, at.y - 20, { steps: 4 });
    await page.mouse.up();
  };
  const still = { x: 'Math.abs(pose.tilt.about_x_rad) < 1e-12', y: 'Math.abs(pose.tilt.about_y_rad) < 1e-12', z: 'Math.abs(pose.axis_height_m - 0.5) < 1e-12' };
  const moved: [string, string][] = [
    ['Drag: along z', `pose.axis_height_m > 0.502 && ${still.x} && ${still.y}`],
    ['Drag: tilt about x', `Math.abs(pose.tilt.about_x_rad) > 1e-3 && ${still.y} && ${still.z}`],
    ['Drag: tilt about y', `Math.abs(pose.tilt.about_y_rad) > 1e-3 && ${still.x} && ${still.z}`],
  ];
  for (const [handle, holds] of moved) {
    await drag(handle);
    await drawn(page, holds);
    await page.keyboard.press('Control+z');
    await drawn(page, `${still.x} && ${still.y} && ${still.z}`);
  }
});

test('number fields of lengths support inches', async () => {
  await open('#pose=tilt,0,1,500,axis');
  await page.getByLabel('Length unit').selectOption('inch');
  await expect.poll(() => value('height')).toBeCloseTo(500 / 25.4, 5);
  await type('height', '20');
  await drawn(page, 'Math.abs(pose.axis_height_m - 0.508) < 1e-12');
  await page.getByRole('button', { name: 'Increase Height by 0.05 in' }).click();
  await drawn(page, 'Math.abs(pose.axis_height_m - 0.50927) < 1e-9');
  await page.getByRole('tab', { name: 'Rods' }).click();
  await type('rod-1', '20.05');
  await drawn(page, 'Math.abs(pose.rods_m[0] - 0.50927) < 1e-9');
  await page.getByLabel('Length unit').selectOption('mm');
  await expect.poll(() => value('rod-1')).toBeCloseTo(509.27, 3);
  await page.getByRole('tab', { name: 'Direction, angle' }).click();
});

test('panels are collapsed, resized and moved, and the layout persists', async () => {
  await open();
  const panels = async (side: string) => (await page.locator(`aside.${side} section h2 .fold`).allTextContents()).map((text) => text.trim());
  const usual = ['Pose', 'Virtualization', 'Displacement at the balls', 'Mobility', 'Sensitivity'];
  await expect.poll(() => panels('right')).toEqual(usual);
  await expect.poll(() => page.locator('aside.left').count()).toBe(0);
  // By the keyboard: one place down, and to the other side.
  await page.getByTestId('grip-pose').focus();
  await page.keyboard.press('ArrowDown');
  await expect.poll(async () => (await panels('right')).slice(0, 2)).toEqual(['Virtualization', 'Pose']);
  await page.keyboard.press('ArrowUp');
  await expect.poll(() => panels('right')).toEqual(usual);
  await page.getByTestId('grip-mobility').focus();
  await page.keyboard.press('ArrowLeft');
  await expect.poll(() => panels('left')).toEqual(['Mobility']);
  // By the pointer: dragged over the panel at the left.
  await page.getByTestId('grip-virtualization').scrollIntoViewIfNeeded();
  const grip = (await page.getByTestId('grip-virtualization').boundingBox())!;
  const over = (await page.getByTestId('grip-mobility').boundingBox())!;
  await page.mouse.move(grip.x + 5, grip.y + 5);
  await page.mouse.down();
  await page.mouse.move(over.x - 40, over.y + 2, { steps: 5 });
  await page.mouse.up();
  await expect.poll(() => panels('left')).toEqual(['Virtualization', 'Mobility']);
  await page.getByRole('separator', { name: 'Width of the panels, left' }).focus();
  await page.keyboard.press('ArrowRight');
  await expect.poll(async () => (await page.locator('aside.left').boundingBox())!.width).toBeCloseTo(392, 0);
  await page.getByRole('button', { name: 'Mobility', exact: true }).click();
  await expect.poll(() => page.getByTestId('kutzbach').count()).toBe(0);
  await reload(page);
  await drawn(page);
  await expect.poll(() => panels('left')).toEqual(['Virtualization', 'Mobility']);
  await expect.poll(async () => (await page.locator('aside.left').boundingBox())!.width).toBeCloseTo(392, 0);
  await expect.poll(() => page.getByTestId('kutzbach').count()).toBe(0);
  await page.locator('body').press('b');
  await expect.poll(() => page.locator('aside').count()).toBe(0);
  await page.locator('body').press('b');
  await page.keyboard.press('?');
  await page.getByRole('button', { name: 'Reset layout' }).click();
  await page.keyboard.press('Escape');
  await expect.poll(() => panels('right')).toEqual(usual);
  await expect.poll(() => page.getByTestId('kutzbach').count()).toBe(1);
});

test('models, solver, metric and visible elements are selected', async () => {
  await open();
  for (const name of ['radial', 'offset', 'planar', 'polar']) {
    await page.getByTestId(`model-${name}`).check();
    await drawn(page, `pose.models[0].model.virtualization === '${name}'`);
  }
  await page.getByTestId('metric').selectOption('radius');
  await drawn(page, "pose.models[0].model.metric === 'radius'");
  await page.getByTestId('solver').selectOption('least-norm');
  await drawn(page, "pose.models[0].answer.solver === 'least-norm'");
  await page.getByTestId('show-ghost').check();
  const gaps = await page.getByTestId('gaps').locator('[data-value]').all();
  expect(gaps).toHaveLength(3);
  for (const gap of gaps) await expect.poll(async () => Number(await gap.getAttribute('data-value'))).toBeGreaterThan(1e-6);
  await page.getByRole('button', { name: 'Why the models differ' }).click();
  await expect.poll(() => page.getByRole('heading', { name: 'Why the models differ' }).isVisible()).toBe(true);
  await page.keyboard.press('Escape');
});

test('the play scale is changed by slider and shortcut', async () => {
  await open();
  const slider = page.getByTestId('exaggeration');
  await slider.fill('0');
  await expect.poll(() => page.getByTestId('play-scale').textContent()).toBe('1×');
  await expect.poll(() => page.getByText('too small to see').isVisible()).toBe(true);
  await slider.fill('1000');
  await expect.poll(() => page.getByTestId('play-scale').textContent()).toBe('2000×');
  await page.keyboard.press('Control+z');
  await page.locator('body').press('-');
});

test('a link restores pose, model, play scale and view', async () => {
  await open('#pose=tilt,30,1,480,center&model=radial,newton,paper&play=50&show=joints,arrows&view=o,300,-500,800,0,0,450,2');
  await page.getByRole('button', { name: 'Copy link' }).click();
  const link = await page.evaluate(() => navigator.clipboard.readText());
  expect(link).toMatch(/#robot=GPR%20of%20the%20paper,[0-9a-f]{8}&pose=/);
  expect(link).toContain('&pose=tilt,30,1,480,center&model=radial,newton,paper&play=50&show=joints,arrows&view=o,300,-500,800,0,0,450,2');
  const other = await visit(browser, CLIPBOARD);
  await load(other, link);
  await drawn(other, "Math.abs(pose.tilt.angle_rad - Math.PI / 180) < 1e-9 && pose.models[0].model.virtualization === 'radial'");
  await other.context().close();
});

test('settings persist between visits', async () => {
  await open();
  await page.getByLabel('Theme').selectOption('dark');
  await page.getByLabel('Length unit').selectOption('inch');
  await type('azimuth', '77');
  await until('the link contains the number', () => page.evaluate(() => window.location.hash.includes('77')));
  await page.goto('about:blank');
  await load(page, server.address);
  await drawn(page);
  await expect.poll(() => page.evaluate(() => document.documentElement.dataset.theme)).toBe('dark');
  await expect.poll(() => page.getByTestId('joints').textContent()).toContain('mil');
  await expect.poll(() => value('azimuth')).toBe(77);
  await page.getByLabel('Theme').selectOption('light');
  await page.getByLabel('Length unit').selectOption('mm');
});

test('view and pose are exported', async () => {
  await open('#pose=rods,500,501,502');
  const take = async (item: string) => {
    await page.getByTestId('export').click();
    const [download] = await Promise.all([page.waitForEvent('download'), page.getByTestId(item).click()]);
    const parts: Buffer[] = [];
    for await (const part of await download.createReadStream()) parts.push(part as Buffer);
    return Buffer.concat(parts);
  };
  const picture = await take('export-view');
  expect(picture.subarray(1, 4).toString()).toBe('PNG');
  expect(picture.length).toBeGreaterThan(20_000);
  const pose = JSON.parse((await take('export-pose')).toString());
  expect(pose.q_mm).toEqual([500, 501, 502]);
});

test('keyboard shortcuts work and are listed', async () => {
  await open();
  await page.keyboard.press('?');
  await expect.poll(() => page.getByRole('heading', { name: 'Keyboard shortcuts' }).isVisible()).toBe(true);
  await page.keyboard.press('Escape');
  await page.keyboard.press('0');
  await drawn(page, 'pose.tilt.angle_rad < 1e-9');
  await page.keyboard.press('k');
  await drawn(page, 'Math.abs(pose.tilt.about_x_rad - 0.1 * Math.PI / 180) < 1e-9');
  await page.keyboard.press('PageUp');
  await drawn(page, 'Math.abs(pose.axis_height_m - 0.501) < 1e-9');
  await page.keyboard.press('m');
  await drawn(page, "pose.models[0].model.virtualization === 'offset'");
  for (const key of ['1', '2', '6', 'f', 'p', 'o', 'o', 'g', 'n', 'v', 'a']) await page.keyboard.press(key);
  await page.keyboard.press('t');
  await expect.poll(() => page.evaluate(() => document.documentElement.dataset.theme)).toBe('dark');
});

test('the page shows a lost connection and recovers after a restart of the server', async () => {
  await open();
  await server.stop();
  await page.getByRole('button', { name: 'Level', exact: true }).click();
  await page.getByTestId('disconnected').waitFor();
  server = await serve(server.port);
  await page.getByTestId('disconnected').waitFor({ state: 'hidden' });
  await drawn(page, 'pose.tilt.angle_rad < 1e-9');
  // The browser itself notes requests without an answer.
  heard.splice(0, heard.length, ...heard.filter((line) => !line.includes('ERR_CONNECTION_REFUSED')));
});

test('the page reports a server of another version after its restart', async () => {
  await open();
  const note = page.getByTestId('other-version');
  await server.stop();
  await page.getByTestId('disconnected').waitFor();
  server = await serve(server.port);
  await page.getByTestId('disconnected').waitFor({ state: 'hidden' });
  await expect.poll(() => note.count(), { message: 'the same version' }).toBe(0);
  await server.stop();
  await page.getByTestId('disconnected').waitFor();
  await page.route((url) => url.pathname === '/', (route) => route.fulfill({ contentType: 'text/html', body: '<script type="module" src="./assets/index-0ther.js"></script>' }));
  server = await serve(server.port);
  await note.waitFor();
  await page.unrouteAll();
  await note.getByRole('button', { name: 'Reload the page' }).click();
  await until('the page of the server', async () => (await note.count()) === 0);
  await drawn(page);
  heard.splice(0, heard.length, ...heard.filter((line) => !line.includes('ERR_CONNECTION_REFUSED')));
});

for (const theme of ['light', 'dark'] as const)
  test(`no accessibility violations, ${theme} theme`, async () => {
    await open();
    await page.getByLabel('Theme').selectOption(theme);
    await expect.poll(() => accessibilityViolations(page)).toEqual([]);
  });
