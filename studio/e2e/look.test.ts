// First steps and pictures of the robot view: the tour, fields for expressions with units, exported pictures.

import { inflateSync } from 'node:zlib';
import type { Browser, Page } from 'playwright-core';
import { afterAll, beforeAll, expect, test } from 'vitest';
import { accessibilityViolations, browse, bytesOf, cellFixture, complaints, drawn, load, partNames, serve, unhandled, until, visit, type Server } from './studio';

let browser: Browser;
let server: Server;

beforeAll(async () => {
  [browser, server] = await Promise.all([browse(), serve()]);
});
afterAll(async () => {
  await browser?.close();
  await server?.stop();
});

async function open(does: (page: Page) => Promise<void>): Promise<void> {
  const page = await visit(browser);
  const heard = complaints(page);
  await load(page, server.address);
  await drawn(page);
  await does(page);
  // The server refuses invalid expressions.
  expect(unhandled(heard).filter((line) => !/status of 422/.test(line))).toEqual([]);
  await page.context().close();
}

test('fields accept expressions and units', () =>
  open(async (page) => {
    const type = async (field: string, text: string) => {
      await page.getByTestId(`field-${field}`).fill(text);
      await page.getByTestId(`field-${field}`).press('Enter');
    };
    await type('tilt', '1/3');
    await drawn(page, 'Math.abs(pose.tilt.angle_rad - Math.PI / 540) < 1e-12');
    await type('tilt', '5 mrad');
    await drawn(page, 'Math.abs(pose.tilt.angle_rad - 0.005) < 1e-12');
    await type('tilt', '1,25');
    await drawn(page, 'Math.abs(pose.tilt.angle_rad - 1.25 * Math.PI / 180) < 1e-12');
    await type('height', '500 + 2 * 0.6');
    await drawn(page, 'Math.abs(pose.axis_height_m - 0.5012) < 1e-12');
    await type('height', '19700 mil');
    await drawn(page, 'Math.abs(pose.axis_height_m - 0.50038) < 1e-12');
    for (const [text, message] of [['2 deg', 'deg is a unit of angles'], ['1/0', 'infinite'], ['high', 'unknown name'], ['(', 'expected']] as const) {
      await type('height', text);
      await page.getByRole('alert').filter({ hasText: message }).waitFor();
      await expect.poll(() => page.getByTestId('field-height').inputValue()).toBe('500.38');
    }
    await page.getByTestId('field-height').press('ArrowUp');
    await drawn(page, 'Math.abs(pose.axis_height_m - 0.50138) < 1e-12');
    await type('tilt', '0.01 rad + 1');
    await page.getByRole('alert').filter({ hasText: 'expected' }).waitFor();
  }));

test('an invalid length or size of a picture is refused with the reason', () =>
  open(async (page) => {
    await page.getByTestId('motion').selectOption({ label: 'Key poses' });
    await page.getByRole('button', { name: 'Poses' }).click();
    const height = page.getByLabel('height mm of pose 2');
    const before = await height.inputValue();
    for (const [text, message] of [['', 'a length is missing'], ['2 deg', 'deg is a unit of angles'], ['wide', 'unknown name'], ['1e', 'expected']] as const) {
      await height.fill(text);
      await height.press('Enter');
      await page.getByRole('alert').filter({ hasText: message }).waitFor();
      await expect.poll(() => height.inputValue()).toBe(before);
    }
    await height.fill('480 + 2');
    await height.press('Enter');
    await until('the height is accepted', async () => (await height.inputValue()) === '482' && (await page.getByRole('alert').count()) === 0);
    await page.getByLabel('seconds of pose 2').fill('-3');
    await page.getByLabel('seconds of pose 2').press('Enter');
    await page.getByRole('alert').filter({ hasText: 'at least 0, got -3' }).waitFor();
    await page.getByTestId('export').click();
    await page.getByTestId('picture-size').selectOption('other');
    for (const [text, message] of [['', 'must be a number'], ['1e9', 'from 16 to 16384'], ['12000.5', 'whole number'], ['16384', 'million pixels']] as const) {
      await page.getByTestId('picture-width').fill(text);
      await page.getByTestId('picture-height').fill('12000');
      await page.getByTestId('picture-problem').filter({ hasText: message }).waitFor();
      await expect.poll(() => page.getByTestId('export-view').isDisabled()).toBe(true);
    }
    await page.getByTestId('picture-width').fill('640');
    await page.getByTestId('picture-height').fill('480');
    await until('it can be exported', () => page.getByTestId('export-view').isEnabled());
  }));

test('the tour has three steps, each with what it is about, and ends for good', () =>
  open(async (page) => {
    const outlined = () => page.evaluate(() => document.querySelector('.toured')?.textContent?.slice(0, 200) ?? '');
    await expect.poll(() => outlined()).toBe('');
    await page.getByTestId('tour-next').press('Enter');
    await page.getByText('1 of 3').waitFor();
    await until('the pose is outlined', async () => (await outlined()).includes('Pose'));
    await page.getByTestId('tour-next').click();
    await until('the models are outlined', async () => (await outlined()).includes('Virtualization'));
    await page.getByTestId('tour-next').click();
    await until('the motions are outlined', async () => (await outlined()).includes('No motion'));
    await expect.poll(() => accessibilityViolations(page)).toEqual([]);
    await page.getByTestId('tour-back').click();
    await page.getByText('2 of 3').waitFor();
    await page.getByTestId('tour-next').click();
    await page.getByTestId('tour-end').click();
    await page.getByRole('button', { name: 'About this view' }).waitFor();
    await expect.poll(() => outlined()).toBe('');
    await page.reload();
    await page.getByRole('button', { name: 'About this view' }).waitFor();
  }));

/** The chunks of a PNG file. */
function chunks(file: Buffer): Map<string, Buffer> {
  const found = new Map<string, Buffer>();
  for (let at = 8; at < file.length; ) {
    const length = file.readUInt32BE(at);
    const name = file.toString('latin1', at + 4, at + 8);
    const data = file.subarray(at + 8, at + 8 + length);
    found.set(name, Buffer.concat([found.get(name) ?? Buffer.alloc(0), data]));
    at += 12 + length;
  }
  return found;
}

test('pictures have any size and resolution, without background and handles', () =>
  open(async (page) => {
    const picture = async (): Promise<Buffer> => {
      if (!(await page.getByTestId('export-view').isVisible())) await page.getByTestId('export').click();
      const [download] = await Promise.all([page.waitForEvent('download'), page.getByTestId('export-view').click()]);
      return bytesOf(download);
    };
    await page.getByTestId('export').click();
    await page.getByTestId('picture-size').selectOption('other');
    for (const [key, value] of [['width', '640'], ['height', '400'], ['dpi', '254']] as const) {
      await page.getByTestId(`picture-${key}`).fill(value);
      await page.getByTestId(`picture-${key}`).press('Tab');
    }
    await page.getByTestId('picture-transparent').check();
    const shown = await picture();
    const parts = chunks(shown);
    const head = parts.get('IHDR')!;
    expect([head.readUInt32BE(0), head.readUInt32BE(4)]).toEqual([640, 400]);
    expect(parts.get('pHYs')!.readUInt32BE(0)).toBe(10_000);
    expect(head[9], 'with transparency').toBe(6);
    // The first pixel of the first line, whatever its filter.
    expect([...inflateSync(parts.get('IDAT')!).subarray(1, 5)]).toEqual([0, 0, 0, 0]);
    // Handles do not matter, labels do.
    await page.getByText('show handles').click();
    expect((await picture()).equals(shown)).toBe(true);
    await page.getByTestId('export').click();
    await page.getByTestId('picture-labels').uncheck();
    expect((await picture()).equals(shown)).toBe(false);
    // Sizes that cannot be rendered are refused.
    await page.getByTestId('export').click();
    await page.getByTestId('picture-width').fill('400000');
    await page.getByTestId('picture-width').press('Tab');
    await page.getByRole('alert').filter({ hasText: 'The width must be from 16 to 16384 pixels, got 400000.' }).waitFor();
    await expect.poll(() => page.getByTestId('export-view').isDisabled()).toBe(true);
  }));

test('the view cube rotates the view of a cell, and zones have a legend', async () => {
  const fixture = await cellFixture();
  const page = await visit(fixture.browser);
  await load(page, fixture.server.address);
  await until('the cell is drawn', async () => (await partNames(page)).length > 0 && (await page.evaluate(() => window.jointplay.probe.cellFrames > 0)));
  const cube = page.getByTestId('cube').locator('.cube');
  const orientation = () => cube.evaluate((element) => element.style.transform);
  await until('the cube shows the orientation', async () => (await orientation()).startsWith('matrix3d'));
  const before = await orientation();
  await page.getByTestId('cube').getByText('Top', { exact: true }).click();
  await until('the view has turned', async () => (await orientation()) !== before);
  // From above, the third row of the rotation is the direction up.
  const [, , x, , , , y, , , , z] = (await orientation()).slice('matrix3d('.length).split(',').map(Number);
  expect(Math.hypot(x!, y!)).toBeLessThan(0.01);
  expect(z).toBeGreaterThan(0.99);
  const legend = page.getByRole('list', { name: 'Legend' });
  for (const text of ['keep-out zone', 'safe zone', 'slots']) await expect.poll(() => legend.getByText(text).isVisible()).toBe(true);
  await fixture.close();
});
