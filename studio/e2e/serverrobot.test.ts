// The robot of the server in two pages, and the robot view without a connection.

import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import type { Browser, Page } from 'playwright-core';
import { afterAll, beforeAll, expect, test } from 'vitest';
import { ROOT, browse, drawn, load, serve, until, visit, type Server } from './studio';

const PAPER = readFileSync(resolve(ROOT, 'crates/jointplay-format/robots/gpr.toml'), 'utf8');
let browser: Browser;
let folder: string;
let file: string;

beforeAll(async () => {
  browser = await browse();
  folder = mkdtempSync(join(tmpdir(), 'studio-'));
  file = join(folder, 'mine.toml');
});
afterAll(async () => {
  await browser?.close();
  rmSync(folder, { recursive: true });
});

async function enter(page: Page, field: string, text: string): Promise<void> {
  await page.getByTestId(field).fill(text);
  await page.getByTestId(field).press('Enter');
}
async function open(server: Server): Promise<Page> {
  const page = await visit(browser);
  await load(page, server.address);
  await drawn(page);
  return page;
}
const notice = (page: Page) => page.getByRole('alert').filter({ hasText: 'The robot of the server has changed: the view shows the new one.' });
/** The largest displacement of the shown pose [m]. */
const play = 'Math.max(...pose.models.map(({ answer }) => Math.abs(answer.play?.displacement_m ?? 0)))';

test('a robot that another page has saved is loaded again', async () => {
  writeFileSync(file, PAPER);
  const server = await serve(0, ['--robot', file]);
  try {
    const first = await open(server);
    const second = await open(server);
    await first.getByTestId('edit-robot').click();
    await until('the fields', async () => (await first.getByTestId('limb-1-radius').count()) === 1);
    for (const limb of [1, 2, 3]) await enter(first, `limb-${limb}-radius`, '60');
    await enter(first, 'field-robot-tilt_limit', '1');
    await until('the text is changed', async () => await first.getByTestId('robot-save').isEnabled());
    await first.keyboard.press('Control+s');
    await until('it is saved', async () => readFileSync(file, 'utf8').includes('60'));
    // A pose in the second page, before or after it has noticed the other robot.
    await enter(second, 'field-tilt', '0.8');
    await notice(second).waitFor();
    await drawn(second, `Math.abs(pose.tilt.angle_rad - 0.8 * Math.PI / 180) < 1e-9 && ${play} < 1e-3`);
    await second.getByText('limit 1.00°').first().waitFor();
    // The page that saved the robot has no notice.
    expect(await notice(first).count()).toBe(0);
    // With its text loaded, a page without unsaved changes follows, too.
    await second.getByTestId('edit-robot').click();
    await until('the text', async () => (await second.getByTestId('limb-1-radius').inputValue()) === '60');
    await enter(first, 'limb-1-radius', '61');
    await until('changed', async () => await first.getByTestId('robot-save').isEnabled());
    await first.keyboard.press('Control+s');
    await expect.poll(() => second.getByTestId('limb-1-radius').inputValue()).toBe('61');
    await notice(second).waitFor();
    // Unsaved changes remain.
    await enter(second, 'limb-2-radius', '70');
    await until('unsaved', async () => await second.getByTestId('robot-save').isEnabled());
    await enter(first, 'limb-1-radius', '62');
    await until('changed', async () => await first.getByTestId('robot-save').isEnabled());
    await first.keyboard.press('Control+s');
    await second.getByRole('alert').filter({ hasText: 'The unsaved changes of this page remain' }).waitFor();
    expect(await second.getByTestId('limb-2-radius').inputValue()).toBe('70');
    await first.context().close();
    await second.context().close();
  } finally {
    await server.stop();
  }
});

test('without a connection, picture and results are marked as outdated', async () => {
  const server = await serve();
  const page = await open(server);
  let again: Server | undefined;
  try {
    await enter(page, 'field-tilt', '1');
    await drawn(page, 'Math.abs(pose.tilt.angle_rad - Math.PI / 180) < 1e-9');
    const mark = page.getByTestId('robot-outdated');
    expect(await mark.count()).toBe(0);
    await server.stop();
    await enter(page, 'field-tilt', '1.3');
    await mark.filter({ hasText: 'Outdated' }).waitFor();
    for (const panel of ['virtualization', 'displacement', 'mobility', 'sensitivity']) await page.getByTestId(`outdated-${panel}`).waitFor();
    expect(await page.getByTestId('outdated-pose').count()).toBe(0);
    again = await serve(server.port);
    await drawn(page, 'Math.abs(pose.tilt.angle_rad - 1.3 * Math.PI / 180) < 1e-9');
    await until('the mark is removed', async () => (await mark.count()) === 0 && (await page.getByTestId('outdated-displacement').count()) === 0);
  } finally {
    await page.context().close();
    await again?.stop();
  }
});
