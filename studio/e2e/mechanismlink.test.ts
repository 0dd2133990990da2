// Links to mechanisms, and their exported pictures and films.

import { readFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { afterAll, afterEach, beforeAll, expect, test } from 'vitest';
import type { Browser, Page } from 'playwright-core';
import { EXAMPLE_CELL, ROOT, SHORT_PROGRAM, accessibilityViolations, browse, bytesOf, complaints, joints, load, serve, unhandled, until, visit, type Server } from './studio';

let server: Server;
let browser: Browser;
let page: Page;
let heard: string[];

beforeAll(async () => {
  [browser, server] = await Promise.all([browse(), serve()]);
  page = await visit(browser, { viewport: { width: 1440, height: 900 } });
  heard = complaints(page);
  await load(page, server.address);
  await page.getByRole('button', { name: 'Mechanism', exact: true }).click();
});
afterAll(async () => {
  await browser?.close();
  await server?.stop();
});
afterEach(() => {
  expect(unhandled(heard.splice(0))).toEqual([]);
});

const camera = (on: Page) => on.evaluate(() => window.jointplay.probe.mechanism?.camera() ?? null);
const link = async (on: Page) => {
  // The button shows for a while that an earlier link was copied.
  await on.getByTestId('mechanism-link').filter({ hasNotText: 'Copied' }).waitFor();
  await on.getByTestId('mechanism-link').click();
  await on.getByTestId('mechanism-link').filter({ hasText: 'Copied' }).waitFor();
  return on.evaluate(() => window.location.href);
};

async function open(entry: string): Promise<void> {
  await page.getByRole('tab', { name: 'Catalogue' }).click();
  await page.getByTestId(`entry-${entry}`).click();
}

/** Opens a link in another tab, and waits until it shows the same as this one. */
async function same(address: string, more: (other: Page) => Promise<void> = async () => undefined): Promise<void> {
  const [here, seen] = [await joints(page), (await camera(page))!];
  const other = await visit(browser, { viewport: { width: 1440, height: 900 } });
  const problems = complaints(other);
  try {
    await load(other, address);
    await until('the joints are at the same places', async () => {
      const there = await joints(other);
      return Object.entries(here).every(([name, at]) => there[name]?.every((value, k) => Math.abs(value - at[k]!) < 1e-9));
    });
    await until('the camera is the same', async () => {
      const there = await camera(other);
      return there !== null && [...there.eye, ...there.target].every((value, k) => Math.abs(value - [...seen.eye, ...seen.target][k]!) < 1e-4);
    });
    await more(other);
    expect(unhandled(problems)).toEqual([]);
  } finally {
    await other.context().close();
  }
}

test('a link opens an entry of the catalogue in its configuration, with selection and camera', async () => {
  await open('four-bar');
  const home = await joints(page);
  await page.getByTestId('value-A').fill('35');
  await page.getByTestId('value-A').press('Enter');
  await until('it has moved', async () => Object.entries(await joints(page)).some(([name, at]) => at.some((value, k) => Math.abs(value - home[name]![k]!) > 1e-4)));
  await until('it rests', async () => (await page.getByText('Moving…').count()) === 0);
  await page.getByRole('button', { name: 'Top', exact: true }).click();
  const address = await link(page);
  expect(address).toContain('#mechanism=four-bar&');
  expect(address).not.toContain('text=');
  await same(address);
});

test('a link contains a changed text', async () => {
  await page.getByRole('tab', { name: 'Text' }).click();
  await page.getByTestId('text-mechanism').locator('.cm-content').click();
  await page.keyboard.press('Control+Home');
  await page.keyboard.insertText('# My own mechanism.\n');
  await until('the text is read', async () => (await page.getByTestId('mechanism-outdated').count()) === 0);
  const address = await link(page);
  expect(address).toContain('text=');
  await same(address, async (other) => {
    await other.getByTestId('text-mechanism').getByText('# My own mechanism.').waitFor();
  });
});

test('a damaged link is reported, and one to an unknown file with the remedy', async () => {
  for (const [fragment, expected] of [['#mechanism=a.toml&text=AAAA', 'damaged'], ['#mechanism=nowhere.toml', 'open the file first']]) {
    const other = await visit(browser);
    try {
      await load(other, server.address + fragment);
      await other.getByTestId('mechanism-notice').filter({ hasText: expected! }).waitFor();
    } finally {
      await other.context().close();
    }
  }
});

test('picture, film and text of a mechanism are exported', async () => {
  const take = async (entry: string) => {
    await page.getByTestId('mechanism-export').click();
    const awaited = page.waitForEvent('download');
    await page.getByTestId(`mechanism-export-${entry}`).click();
    const download = await awaited;
    return { name: download.suggestedFilename(), bytes: await bytesOf(download) };
  };
  const picture = await take('view');
  expect([picture.name, picture.bytes.subarray(1, 4).toString()]).toEqual(['four-bar.png', 'PNG']);
  const text = await take('text');
  expect(text.bytes.toString()).toContain('# My own mechanism.');
  await page.getByTestId('mechanism-export').click();
  await expect.poll(() => accessibilityViolations(page, '.menu')).toEqual([]);
  // No field is cut off at the edge of the menu.
  const menu = (await page.locator('.menu').boundingBox())!;
  for (const field of ['motion-joint', 'motion-from', 'motion-to', 'motion-steps']) {
    const box = (await page.getByTestId(field).boundingBox())!;
    expect(box.x + box.width, field).toBeLessThanOrEqual(menu.x + menu.width - 6);
  }
  await page.getByTestId('mechanism-export-video').click();
  await page.getByTestId('mechanism-stop-recording').waitFor();
  const frames = await page.evaluate(() => window.jointplay.probe.mechanismFrames);
  await page.getByRole('button', { name: 'Front', exact: true }).click();
  await until('it is recorded', async () => (await page.evaluate(() => window.jointplay.probe.mechanismFrames)) > frames);
  const awaited = page.waitForEvent('download');
  await page.getByTestId('mechanism-stop-recording').click();
  expect((await awaited).suggestedFilename()).toMatch(/^four-bar\.(mp4|webm)$/);
});

test('a mechanism that is opened from another view has its own camera, also a model with the file that closes its loops', async () => {
  await open('bennett');
  const before = (await camera(page))!;
  await page.getByRole('button', { name: 'Robot', exact: true }).click();
  const urdf = '<robot name="arm"><link name="base"/><link name="a"/><link name="b"/><joint name="A" type="continuous"><parent link="base"/><child link="a"/><axis xyz="0 0 1"/></joint><joint name="B" type="prismatic"><parent link="a"/><child link="b"/><origin xyz="20 0 0"/><axis xyz="0 0 1"/><limit lower="0" upper="0.1" effort="1" velocity="1"/></joint></robot>';
  const loops = 'kind = "loops"\nunits = { length = "m", angle = "rad" }\n[[joint]]\nname = "C"\nkind = "cylindrical"\nlinks = ["base", "b"]\npoint = [20, 0, 0]\naxis = [0, 0, 1]\n';
  const dropped = await page.evaluateHandle((texts) => {
    const data = new DataTransfer();
    for (const [name, text] of texts) data.items.add(new File([text!], name!));
    return data;
  }, [['arm-loops.toml', loops], ['arm.urdf', urdf]]);
  await page.dispatchEvent('main', 'drop', { dataTransfer: dropped });
  await until('its joints are drawn', async () => 'C' in (await joints(page)));
  await expect.poll(() => page.locator('dialog[open]').count()).toBe(0);
  await until('the camera is not that of the mechanism before', async () => Math.abs((await camera(page))!.target[0]! - before.target[0]!) > 0.1);
});

test('the dialog Open opens files of each kind in their view, and remembers them', async () => {
  const shown = async (name: string) => until(`${name} is shown`, async () => (await page.getByTestId('mechanism-name').textContent()) === name);
  const dialog = page.getByRole('dialog', { name: 'Open' });
  const choose = (name: string, text: string) => page.getByTestId('open-file').setInputFiles({ name, mimeType: 'text/plain', buffer: Buffer.from(text) });
  await page.keyboard.press('Control+o');
  await dialog.waitFor();
  await expect.poll(() => accessibilityViolations(page, 'dialog[open]')).toEqual([]);
  // A sample, found by its title.
  await dialog.getByPlaceholder('Search').fill('bennett');
  await dialog.getByTestId('sample-bennett').click();
  await dialog.waitFor({ state: 'hidden' });
  await until('its joints are drawn', async () => Object.keys(await joints(page)).length === 4);
  // A text without a kind, and a work cell that this server has no view for, are refused with the remedy.
  await page.keyboard.press('Control+o');
  await choose('notes.toml', 'title = "no kind"\n');
  await page.getByTestId('open-problem').filter({ hasText: 'kind = "mechanism"' }).waitFor();
  await choose('cell.toml', EXAMPLE_CELL);
  await page.getByTestId('open-problem').filter({ hasText: 'jointplay studio cell.toml' }).waitFor();
  await choose('mine.program', SHORT_PROGRAM);
  await page.getByTestId('open-problem').filter({ hasText: 'mine.program is a program of a work cell, and this server was started without one' }).waitFor();
  await choose('sensor.toml', 'kind = "part"\n');
  await page.getByTestId('open-problem').filter({ hasText: 'sensor.toml: This is a part of work cells' }).waitFor();
  // A file opens, and is recent afterwards.
  const mine = readFileSync(resolve(ROOT, 'crates/jointplay-format/robots/four-bar.toml'), 'utf8').replace(/^name = "[^"]*"/m, 'name = "My linkage"');
  await choose('mine.toml', mine);
  await shown('My linkage');
  await page.keyboard.press('Control+o');
  await dialog.getByTestId('sample-bennett').click();
  await dialog.waitFor({ state: 'hidden' });
  await page.keyboard.press('Control+o');
  await dialog.getByTestId('recent-mine.toml').click();
  await shown('My linkage');
  // A robot opens in its own view.
  await page.keyboard.press('Control+o');
  await choose('robot.toml', readFileSync(resolve(ROOT, 'crates/jointplay-format/robots/gpr.toml'), 'utf8'));
  await page.getByTestId('slider-tilt').waitFor();
  await page.keyboard.press('Control+o');
  await dialog.getByTestId('forget-recent').click();
  await expect.poll(() => dialog.getByTestId('recent-mine.toml').count()).toBe(0);
  await page.keyboard.press('Escape');
  await dialog.waitFor({ state: 'hidden' });
});
