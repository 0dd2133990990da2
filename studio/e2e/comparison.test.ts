// The reference of a comparison next to the shown mechanism: pixels of both panes, camera, drags, selection, export, narrow windows.

import type { Browser, Page } from 'playwright-core';
import { afterAll, beforeAll, expect, test } from 'vitest';
import { accessibilityViolations, browse, bytesOf, complaints, frames, load, serve, unhandled, until, visit, type Server } from './studio';

/** A pixel is of a link of the mechanism if its blue is above its red by this number of levels. */
const BLUE_LEVELS = 60;
/** Least share of such pixels in a pane with a four-bar linkage: a bar 200 pixels long and 2 wide in 500 000 pixels is 0.08 %. */
const DRAWN_SHARE = 2e-4;
/** Two pictures of a pane differ if more than this share of their pixels does, by more than 24 levels. */
const CHANGED_SHARE = 1e-3;

interface Rectangle {
  left: number;
  top: number;
  right: number;
  bottom: number;
}

let browser: Browser;
let server: Server;
/** A page without a security policy, which decodes pictures. */
let judge: Page;

beforeAll(async () => {
  [browser, server] = await Promise.all([browse(), serve(0, ['four-bar'])]);
  judge = await visit(browser);
});
afterAll(async () => {
  await browser?.close();
  await server?.stop();
});

/** The share of blue pixels in parts of a picture, given as shares of its edges; `other` is a picture that it is compared with. */
async function shares(picture: Buffer, parts: Rectangle[], other = picture): Promise<{ blue: number; changed: number }[]> {
  return judge.evaluate(
    async ({ pictures, parts, levels }) => {
      const [a, b] = await Promise.all(
        pictures.map(async (base64) => {
          const bitmap = await createImageBitmap(new Blob([Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0))], { type: 'image/png' }));
          const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext('2d')!;
          context.drawImage(bitmap, 0, 0);
          return context.getImageData(0, 0, bitmap.width, bitmap.height);
        }),
      );
      return parts.map(({ left, top, right, bottom }) => {
        let [blue, changed, count] = [0, 0, 0];
        for (let y = Math.ceil(top * a!.height); y < Math.floor(bottom * a!.height); y++)
          for (let x = Math.ceil(left * a!.width); x < Math.floor(right * a!.width); x++) {
            const at = 4 * (y * a!.width + x);
            count += 1;
            blue += Number(a!.data[at + 2]! - a!.data[at]! > levels);
            changed += Number([0, 1, 2].some((k) => Math.abs(a!.data[at + k]! - b!.data[at + k]!) > 24));
          }
        return { blue: blue / count, changed: changed / count };
      });
    },
    { pictures: [picture, other].map((bytes) => bytes.toString('base64')), parts, levels: BLUE_LEVELS },
  );
}

const probe = (page: Page) =>
  page.evaluate(() => {
    const { mechanism } = window.jointplay.probe;
    return { panes: mechanism!.panes(), camera: mechanism!.camera()!, joints: mechanism!.joints() };
  });
const onPage = (page: Page, joint: string) => page.evaluate((name) => window.jointplay.probe.mechanism!.onPage(name)!, joint);
const referenceOnPage = (page: Page, joint: string) => page.evaluate((name) => window.jointplay.probe.mechanism!.referenceOnPage(name)!, joint);
const rests = (page: Page) => until('it rests', async () => (await page.getByText('Moving…').count()) === 0);

/** A picture of the view, and its panes as shares of its edges; that of the shown mechanism is the first one. */
async function view(page: Page): Promise<{ picture: Buffer; parts: Rectangle[] }> {
  await frames(page);
  const { panes } = await probe(page);
  const picture = await page.locator('.mechanism .scene').screenshot();
  const [left, top] = [Math.min(...panes.map((pane) => pane.left)), Math.min(...panes.map((pane) => pane.top))];
  const [width, height] = [Math.max(...panes.map((pane) => pane.right)) - left, Math.max(...panes.map((pane) => pane.bottom)) - top];
  return { picture, parts: panes.map((pane) => ({ left: (pane.left - left) / width, right: (pane.right - left) / width, top: (pane.top - top) / height, bottom: (pane.bottom - top) / height })) };
}

async function at(width: number, height: number, colorScheme: 'light' | 'dark', does: (page: Page) => Promise<void>): Promise<void> {
  const page = await visit(browser, { viewport: { width, height }, colorScheme, deviceScaleFactor: 1 });
  const heard = complaints(page);
  try {
    await load(page, server.address);
    await until('the mobility', async () => (await page.getByTestId('m-finite').count()) === 1);
    await does(page);
    expect(unhandled(heard)).toEqual([]);
  } finally {
    await page.context().close();
  }
}

/** Takes the shown state as reference, draws it next to the mechanism by the keyboard, and drives the crank. */
async function compare(page: Page): Promise<void> {
  await page.getByTestId('take-reference').click();
  await page.getByTestId('reference-overlaid').focus();
  await page.keyboard.press('ArrowDown');
  await expect.poll(() => page.getByTestId('reference-separate').isChecked()).toBe(true);
  await page.getByTestId('value-A').fill('60');
  await page.getByTestId('value-A').press('Enter');
  await until('driven', async () => Math.abs(Number(await page.locator('[data-testid=compare-A] td').nth(2).textContent()) - 60) < 1e-6);
  await rests(page);
}

const move = async (page: Page, from: { x: number; y: number }, by: [number, number]) => {
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  for (const share of [0.3, 0.6, 1]) await page.mouse.move(from.x + share * by[0], from.y + share * by[1]);
  await page.mouse.up();
};

test('reference and shown mechanism are side by side with one camera, and only the shown one is moved', async () => {
  await at(1440, 900, 'light', async (page) => {
    await compare(page);
    await expect.poll(async () => [await page.getByTestId('reference-name').textContent(), await page.locator('.title.shown').textContent()]).toEqual(['Reference: Planar four-bar linkage', 'Shown: Planar four-bar linkage']);
    const { panes: [shown, reference] } = await probe(page);
    expect([reference!.right, reference!.top, reference!.bottom]).toEqual([shown!.left, shown!.top, shown!.bottom]);
    // Both halves have pixels of the linkage.
    const first = await view(page);
    for (const { blue } of await shares(first.picture, first.parts)) expect(blue).toBeGreaterThan(DRAWN_SHARE);
    // The base is at the same place of both halves, and the crank is not.
    const offset = async (joint: string) => {
      const [a, b] = [await onPage(page, joint), await referenceOnPage(page, joint)];
      return Math.hypot(a.x - b.x - (shown!.left - reference!.left), a.y - b.y);
    };
    await expect.poll(() => offset('D')).toBeLessThan(1e-6);
    await expect.poll(() => offset('B')).toBeGreaterThan(20);
    // Orbiting in the left half changes both.
    await move(page, { x: reference!.left + 40, y: reference!.bottom - 80 }, [90, -40]);
    const turned = await view(page);
    for (const { changed } of await shares(turned.picture, turned.parts, first.picture)) expect(changed).toBeGreaterThan(CHANGED_SHARE);
    await expect.poll(() => offset('D')).toBeLessThan(1e-6);
    // The wheel zooms to the cursor in its half.
    const before = await referenceOnPage(page, 'C');
    await page.mouse.move(before.x, before.y);
    const far = await offset('B');
    await page.mouse.wheel(0, -120);
    await until('nearer', async () => (await offset('B')) > far + 1);
    const after = await referenceOnPage(page, 'C');
    expect(Math.hypot(after.x - before.x, after.y - before.y)).toBeLessThan(12);
    await page.getByRole('button', { name: 'Fit', exact: true }).click();
    await frames(page);
    // A drag on the reference turns the view, and moves nothing.
    const { joints: kept, camera } = await probe(page);
    await move(page, await referenceOnPage(page, 'B'), [10, 60]);
    await frames(page);
    await expect.poll(async () => (await probe(page)).joints).toEqual(kept);
    await expect.poll(async () => (await probe(page)).camera).not.toEqual(camera);
    // A drag in the right half moves the link, and the reference stays where it is.
    await page.getByRole('button', { name: 'Fit', exact: true }).click();
    await frames(page);
    const [still, from] = [await view(page), await referenceOnPage(page, 'B')];
    await move(page, await onPage(page, 'B'), [20, -60]);
    await rests(page);
    await until('dragged', async () => Math.hypot(...(await probe(page)).joints['B']!.map((value, k) => value - kept['B']![k]!)) > 0.01);
    await expect.poll(() => referenceOnPage(page, 'B')).toEqual(from);
    const dragged = await view(page);
    const [right] = await shares(dragged.picture, dragged.parts, still.picture);
    expect(right!.changed).toBeGreaterThan(CHANGED_SHARE);
    // A part that is clicked in the reference is selected in both halves.
    await page.keyboard.press('Escape');
    const { x, y } = await referenceOnPage(page, 'C');
    await page.mouse.click(x, y);
    await page.locator('[data-testid=tree-joint-C][aria-pressed=true]').waitFor();
    await expect.poll(() => accessibilityViolations(page)).toEqual([]);
  });
});

test('both halves are exported with their names, and the choice is remembered', async () => {
  await at(1440, 900, 'light', async (page) => {
    await compare(page);
    const take = async (entry: string) => {
      await page.getByTestId('mechanism-export').click();
      const awaited = page.waitForEvent('download');
      await page.getByTestId(`mechanism-export-${entry}`).click();
      return bytesOf(await awaited);
    };
    const halves = [{ left: 0, right: 0.5, top: 0, bottom: 1 }, { left: 0.5, right: 1, top: 0, bottom: 1 }];
    const picture = await take('view');
    for (const { blue } of await shares(picture, halves)) expect(blue).toBeGreaterThan(DRAWN_SHARE);
    const svg = (await take('vectors')).toString();
    for (const name of ['Reference: Planar four-bar linkage', 'Shown: Planar four-bar linkage']) expect(svg).toContain(name);
    // Labels of the same joint are in both halves.
    expect(svg.match(/>D</g)?.length).toBe(2);
    // By the key B: not drawn, overlaid, side by side again.
    const panes = async () => (await probe(page)).panes.length;
    await page.locator('body').press('b');
    await until('one pane', async () => (await panes()) === 1);
    await expect.poll(() => page.getByTestId('reference-hidden').isChecked()).toBe(true);
    await page.locator('body').press('b');
    await expect.poll(() => page.getByTestId('reference-overlaid').isChecked()).toBe(true);
    await page.locator('body').press('b');
    await until('two panes', async () => (await panes()) === 2);
    await page.getByTestId('clear-reference').click();
    await until('one pane', async () => (await panes()) === 1);
    await page.getByTestId('take-reference').click();
    await until('two panes again', async () => (await panes()) === 2);
  });
});

test('another mechanism is drawn at the same scale, as large as both halves allow', async () => {
  await at(1024, 700, 'dark', async (page) => {
    await page.getByTestId('take-reference').click();
    await page.getByTestId('reference-separate').check();
    const bars = (await probe(page)).joints;
    await page.getByRole('tab', { name: 'Catalogue' }).click();
    await page.getByTestId('entry-gpr-mechanism').click();
    await until('opened', async () => Object.hasOwn((await probe(page)).joints, 'S1'));
    await page.getByRole('button', { name: 'Top', exact: true }).click();
    await frames(page);
    // In this view, lengths on the page are lengths in the plane, but for the perspective.
    const scale = (joints: Record<string, number[]>, from: string, to: string, [a, b]: { x: number; y: number }[]) => Math.hypot(a!.x - b!.x, a!.y - b!.y) / Math.hypot(joints[from]![0]! - joints[to]![0]!, joints[from]![1]! - joints[to]![1]!);
    const reference = scale(bars, 'A', 'D', [await referenceOnPage(page, 'A'), await referenceOnPage(page, 'D')]);
    const shown = scale((await probe(page)).joints, 'S1', 'S2', [await onPage(page, 'S1'), await onPage(page, 'S2')]);
    expect(shown / reference).toBeGreaterThan(0.75);
    expect(shown / reference).toBeLessThan(1.35);
    // Every joint is in its half.
    const { panes: [own, other], joints } = await probe(page);
    const isIn = ({ x, y }: { x: number; y: number }, pane: Rectangle) => x > pane.left && x < pane.right && y > pane.top && y < pane.bottom;
    for (const name of Object.keys(joints)) expect(isIn(await onPage(page, name), own!), name).toBe(true);
    for (const name of Object.keys(bars)) await expect.poll(async () => isIn(await referenceOnPage(page, name), other!), { message: name }).toBe(true);
    await expect.poll(() => accessibilityViolations(page)).toEqual([]);
  });
});

test('in a narrow window, the reference is above the shown mechanism', async () => {
  await at(390, 844, 'dark', async (page) => {
    await compare(page);
    await page.locator('.mechanism .scene').scrollIntoViewIfNeeded();
    await page.getByRole('button', { name: 'Fit', exact: true }).click();
    await frames(page);
    const { panes: [shown, reference], joints } = await probe(page);
    expect([reference!.bottom, reference!.left, reference!.right]).toEqual([shown!.top, shown!.left, shown!.right]);
    expect(shown!.bottom - shown!.top).toBeGreaterThan(200);
    const { picture, parts } = await view(page);
    for (const { blue } of await shares(picture, parts)) expect(blue).toBeGreaterThan(DRAWN_SHARE);
    await move(page, await onPage(page, 'B'), [15, -25]);
    await rests(page);
    await until('dragged', async () => Math.hypot(...(await probe(page)).joints['B']!.map((value, k) => value - joints['B']![k]!)) > 0.005);
    await expect.poll(() => accessibilityViolations(page)).toEqual([]);
    await expect.poll(() => page.evaluate(() => document.documentElement.scrollWidth)).toBeLessThanOrEqual(390);
  });
});
