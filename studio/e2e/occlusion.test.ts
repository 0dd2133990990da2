// Ambient occlusion: a picture at rest is darker than a moving one where parts shade each other.

import type { Browser, Page } from 'playwright-core';
import { afterAll, beforeAll, expect, test } from 'vitest';
import { browse, complaints, drawn, frames, load, serve, unhandled, until, visit, waitForCheck, type Server } from './studio';

/** Averages over blocks of this edge are compared: edges are smooth at rest only. */
const BLOCK = 4;
/** A block is darker or brighter if its average differs by more levels. */
const LEVELS = 12;
/** Least share of blocks that are darker at rest, and largest share of brighter ones: edges alone make 0.2 % darker and 0.3 % brighter. */
const SHARES = { darker: 5e-3, brighter: 6e-3 } as const;

let browser: Browser;
let server: Server;

beforeAll(async () => {
  [browser, server] = await Promise.all([browse(), serve()]);
});
afterAll(async () => {
  await browser?.close();
  await server?.stop();
});

/** A page that shows the platform; one without stills keeps its last moving picture, in the full resolution. */
async function open(stills: boolean): Promise<{ page: Page; heard: string[]; resolution: () => Promise<number> }> {
  const page = await visit(browser, { viewport: { width: 1200, height: 800 }, deviceScaleFactor: 1 });
  const heard = complaints(page);
  await page.addInitScript((stills) => {
    localStorage.setItem('jointplay.studio.introduction', 'false');
    const { setTimeout } = window;
    if (stills) return;
    // Slow frames reduce the resolution; frames a second apart are pauses.
    const now = performance.now.bind(performance);
    performance.now = () => 1000 * now();
    // The time without changes before a still picture.
    window.setTimeout = ((run: () => void, ms?: number) => (ms !== undefined && ms >= 400 && ms <= 900 ? 0 : setTimeout(run, ms))) as typeof window.setTimeout;
  }, stills);
  await load(page, `${server.address}#pose=tilt,30,1.2,500,axis&model=polar,newton,paper&play=500&show=joints`);
  await drawn(page, 'Math.abs(pose.tilt.angle_rad - 1.2 * Math.PI / 180) < 1e-9');
  await page.keyboard.press('p');
  await frames(page);
  return { page, heard, resolution: () => resolution(page) };
}

/** Pixels of the picture for each pixel of the page. */
const resolution = (page: Page) =>
  page.evaluate(() => {
    const canvas = document.querySelector<HTMLCanvasElement>('canvas[role=img]')!;
    return canvas.width / canvas.clientWidth;
  });

/** The shares of blocks of the view that are darker and brighter in the second picture. */
async function differences(pictures: [Buffer, Buffer]): Promise<{ darker: number; brighter: number }> {
  const judge = await visit(browser);
  const found = await judge.evaluate(
    async ({ pictures, block, levels }) => {
      const [a, b] = await Promise.all(
        pictures.map(async (base64) => {
          const bitmap = await createImageBitmap(new Blob([Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0))], { type: 'image/png' }));
          const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext('2d')!;
          context.drawImage(bitmap, 0, 0);
          return context.getImageData(0, 0, bitmap.width, bitmap.height);
        }),
      );
      let [darker, brighter, count] = [0, 0, 0];
      for (let top = 0; top + block <= a!.height; top += block)
        for (let left = 0; left + block <= a!.width; left += block) {
          let sum = 0;
          for (let y = top; y < top + block; y++) for (let x = left; x < left + block; x++) for (let k = 0; k < 3; k++) sum += b!.data[4 * (y * a!.width + x) + k]! - a!.data[4 * (y * a!.width + x) + k]!;
          const mean = sum / (3 * block ** 2);
          count += 1;
          darker += Number(mean < -levels);
          brighter += Number(mean > levels);
        }
      return { darker: darker / count, brighter: brighter / count };
    },
    { pictures: pictures.map((bytes) => bytes.toString('base64')), block: BLOCK, levels: LEVELS },
  );
  await judge.context().close();
  return found;
}

test('a view at rest is darker where parts shade each other', async () => {
  const [moving, still] = await Promise.all([open(false), open(true)]);
  await until('a still picture', async () => (await still.resolution()) > 1.5);
  await frames(still.page);
  expect(await moving.resolution()).toBe(1);
  const scene = (page: Page) => page.locator('canvas[role=img]').screenshot();
  const rest = await scene(still.page);
  const found = await differences([await scene(moving.page), rest]);
  expect(found.darker).toBeGreaterThan(SHARES.darker);
  expect(found.brighter).toBeLessThan(SHARES.brighter);
  expect(unhandled([...moving.heard, ...still.heard])).toEqual([]);
  await moving.page.context().close();
  await still.page.context().close();
});

/** Largest change of the slope of the brightness from row to row within a picture [levels]. */
async function stripes(page: Page, picture: Buffer): Promise<number> {
  const rows = await page.evaluate(async (base64) => {
    const bitmap = await createImageBitmap(new Blob([Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0))], { type: 'image/png' }));
    const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext('2d')!;
    context.drawImage(bitmap, 0, 0);
    const { data, width, height } = context.getImageData(0, 0, bitmap.width, bitmap.height);
    return Array.from({ length: height }, (_, y) => Array.from({ length: width }, (_, x) => data[4 * (y * width + x) + 1]!).reduce((sum, level) => sum + level / width, 0));
  }, picture.toString('base64'));
  return Math.max(...rows.slice(1, -1).map((level, i) => Math.abs(rows[i]! - 2 * level + rows[i + 2]!)));
}

test('a wall that is seen at a small angle does not shade itself in stripes', async () => {
  const cell = await serve(0, ['--cell', 'example']);
  const page = await visit(browser, { viewport: { width: 1440, height: 900 }, deviceScaleFactor: 2 });
  const heard = complaints(page);
  await load(page, cell.address);
  // The panels around the view are those of the plan from here on.
  await waitForCheck(page, 'passed');
  await until('the cell is drawn', () => page.evaluate(() => window.jointplay.probe.cellFrames > 0));
  await until('a still picture', async () => (await resolution(page)) > 1.5);
  await page.locator('body').press('2');
  await until('a moving picture', async () => (await resolution(page)) < 1.5);
  await until('a still picture from above', async () => (await resolution(page)) > 1.5);
  await frames(page);
  // The face of the wall, without its edges.
  expect(await stripes(page, await page.screenshot({ clip: { x: 665, y: 537, width: 120, height: 38 } }))).toBeLessThan(1);
  expect(unhandled(heard)).toEqual([]);
  await page.context().close();
  await cell.stop();
});
