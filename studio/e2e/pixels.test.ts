// Pictures of key views, compared with pictures in `pixels/`; `UPDATE_PIXELS=1` writes them.
//
// Software rendering repeats itself on one machine. Other versions of driver or compiler change edges and shades a little:
// averages over blocks of 4 × 4 pixels are compared, a block is different beyond 24 of 255 levels, and 0.5 % of the blocks may be.
// A part that is missing, misplaced or of another colour changes more: the last test shows that such changes are found.

import { existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { resolve } from 'node:path';
import type { Browser, Page } from 'playwright-core';
import { afterAll, beforeAll, expect, test } from 'vitest';
import { bytesOf, cellFixture, drawn, load, until, visit, type CellFixture } from './studio';

const BLOCK = 4;
const LEVELS = 24;
const SHARE = 0.005;
/** Height of the note at the lower edge, whose font differs between machines [px]. */
const NOTE = 28;
const SIZE = { width: 360, height: 240, dpi: 96 };

let fixture: CellFixture;
let browser: Browser;
/** A page without a security policy, which decodes and compares pictures. */
let judge: Page;

beforeAll(async () => {
  fixture = await cellFixture();
  browser = fixture.browser;
  judge = await visit(browser);
});
afterAll(() => fixture?.close());

/** The share of blocks that differ. */
async function difference(one: Buffer, other: Buffer): Promise<number> {
  return judge.evaluate(
    async ({ pictures, block, levels, note }) => {
      const [a, b] = await Promise.all(
        pictures.map(async (base64) => {
          const bytes = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
          const bitmap = await createImageBitmap(new Blob([bytes], { type: 'image/png' }));
          const canvas = new OffscreenCanvas(bitmap.width, bitmap.height);
          const context = canvas.getContext('2d')!;
          context.drawImage(bitmap, 0, 0);
          return { width: bitmap.width, height: bitmap.height, data: context.getImageData(0, 0, bitmap.width, bitmap.height).data };
        }),
      );
      if (a!.width !== b!.width || a!.height !== b!.height) return 1;
      let [different, count] = [0, 0];
      for (let top = 0; top + block <= a!.height - note; top += block)
        for (let left = 0; left + block <= a!.width; left += block) {
          const sums = [0, 0, 0];
          for (let y = top; y < top + block; y++)
            for (let x = left; x < left + block; x++) for (let k = 0; k < 3; k++) sums[k]! += a!.data[4 * (y * a!.width + x) + k]! - b!.data[4 * (y * a!.width + x) + k]!;
          count += 1;
          different += Number(Math.max(...sums.map(Math.abs)) / block ** 2 > levels);
        }
      return different / count;
    },
    { pictures: [one, other].map((bytes) => bytes.toString('base64')), block: BLOCK, levels: LEVELS, note: NOTE },
  );
}

/** A page of a view whose pictures are without texts and in a size that does not depend on the window. */
async function open(part: 'robot' | 'cell', hash = ''): Promise<Page> {
  const page = await visit(browser, { viewport: { width: 1280, height: 720 } });
  await page.addInitScript(
    ({ part, size }) => {
      const settings = { part, theme: 'light', picture: { size: 'other', other: size, transparent: false, labels: false } };
      for (const [key, value] of Object.entries(settings)) localStorage.setItem(`jointplay.studio.${key}`, JSON.stringify(value));
    },
    { part, size: SIZE },
  );
  await load(page, `${fixture.server.address}${hash}`);
  return page;
}

async function picture(page: Page, menu: 'export' | 'cell-export'): Promise<Buffer> {
  await page.getByTestId(menu).click();
  const [download] = await Promise.all([page.waitForEvent('download'), page.getByTestId(`${menu}-view`).click()]);
  return bytesOf(download);
}

async function compare(name: string, found: Buffer): Promise<void> {
  const file = resolve(import.meta.dirname, `pixels/${name}.png`);
  if (process.env.UPDATE_PIXELS) {
    mkdirSync(resolve(file, '..'), { recursive: true });
    writeFileSync(file, found);
  }
  if (!existsSync(file)) throw new Error(`${file} is missing: UPDATE_PIXELS=1 writes it`);
  expect(await difference(found, readFileSync(file)), `share of different blocks of ${name}`).toBeLessThanOrEqual(SHARE);
}

test('the robot looks as before, and changes of pose, model and theme are found', async () => {
  const page = await open('robot', '#pose=tilt,30,1.2,500,axis&model=polar,newton,paper&play=2000&show=joints,arrows,frames');
  await drawn(page, 'Math.abs(pose.tilt.angle_rad - 1.2 * Math.PI / 180) < 1e-9');
  await compare('robot', await picture(page, 'export'));
  await page.locator('body').press('p');
  const platform = await picture(page, 'export');
  await compare('platform', platform);
  const changed = async () => expect(await difference(await picture(page, 'export'), platform)).toBeGreaterThan(SHARE);
  await page.getByTestId('field-tilt').fill('-1.2');
  await page.getByTestId('field-tilt').press('Enter');
  await drawn(page, 'pose.tilt.azimuth_rad < 0');
  await changed();
  await page.getByTestId('field-tilt').fill('1.2');
  await page.getByTestId('field-tilt').press('Enter');
  await drawn(page, 'pose.tilt.azimuth_rad > 0');
  expect(await difference(await picture(page, 'export'), platform)).toBeLessThanOrEqual(SHARE);
  await page.getByRole('radio', { name: 'radial' }).check();
  await drawn(page, "pose.models[0].model.virtualization === 'radial'");
  await changed();
  await page.getByRole('radio', { name: 'polar' }).check();
  await drawn(page, "pose.models[0].model.virtualization === 'polar'");
  await page.getByLabel('Theme').selectOption('dark');
  await changed();
  await compare('platform-dark', await picture(page, 'export'));
  await page.context().close();
});

test('the cell looks as before', async () => {
  const page = await open('cell');
  await until('the cell is drawn', () => page.evaluate(() => window.jointplay.probe.cellFrames > 0 && (window.jointplay.probe.cell?.parts().length ?? 0) > 0));
  await compare('cell', await picture(page, 'cell-export'));
  await page.context().close();
});
