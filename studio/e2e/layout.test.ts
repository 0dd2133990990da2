// Layout: the 3D view is visible in windows of all sizes, and no control is covered or cut off.

import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { readFileSync } from 'node:fs';
import type { Browser, Page } from 'playwright-core';
import { afterAll, beforeAll, expect, test } from 'vitest';
import { ROOT, browse, complaints, drawn, frames, load, reload, serve, until, visit, type Server } from './studio';

let browser: Browser;
let server: Server;
let folder: string;

beforeAll(async () => {
  folder = mkdtempSync(join(tmpdir(), 'studio-'));
  writeFileSync(join(folder, 'mine.toml'), readFileSync(resolve(ROOT, 'crates/jointplay-format/cells/example.toml'), 'utf8'));
  writeFileSync(join(folder, 'mine.program'), 'HOME\nGET LP1 SLOT 1 WITH A\nPUT ALIGN WITH A\nHOME\n');
  [browser, server] = await Promise.all([browse(), serve(0, ['--cell', join(folder, 'mine.toml')])]);
});
afterAll(async () => {
  await browser?.close();
  await server?.stop();
  rmSync(folder, { recursive: true });
});

async function at(width: number, height: number, part: 'robot' | 'cell' | 'mechanism', does: (page: Page) => Promise<void>): Promise<void> {
  const page = await visit(browser, { viewport: { width, height } });
  const heard = complaints(page);
  try {
    await page.addInitScript((shown) => sessionStorage.setItem('jointplay.studio.part', shown), part);
    await load(page, server.address);
    if (part === 'robot') await drawn(page);
    else if (part === 'cell') await until('the result is there', async () => (await page.getByTestId('check-result').getAttribute('data-state')) === 'passed');
    await does(page);
    expect(heard).toEqual([]);
  } finally {
    await page.context().close();
  }
}

/** Buttons that reach beyond the window, where nothing scrolls to them. */
const cut = (page: Page) =>
  page.evaluate(() =>
    [...document.querySelectorAll<HTMLElement>('header button, header select, .transport *, .views *')]
      .filter((one) => one.getBoundingClientRect().width > 0)
      .filter((one) => one.getBoundingClientRect().left < 0 || one.getBoundingClientRect().right > window.innerWidth + 0.5)
      .map((one) => one.textContent ?? ''),
  );

for (const [width, height] of [[390, 844], [500, 900], [512, 350], [720, 450], [1024, 700], [1280, 720]] as const) {
  test(`the robot is visible in a window of ${width} × ${height}`, () =>
    at(width, height, 'robot', async (page) => {
      const scene = (await page.locator('.scene').boundingBox())!;
      expect(scene.width).toBeGreaterThanOrEqual(Math.min(width, 600));
      expect(scene.height).toBeGreaterThanOrEqual(Math.min(260, 0.5 * height));
      expect(scene.y + 200, 'in view').toBeLessThan(height);
      // Unasked, no card lies over the middle of the picture, where the robot is.
      const over = await page.evaluate(
        ([x, y]) => document.elementsFromPoint(x!, y!).findIndex((one) => one.closest('.story, .dialog, aside') !== null),
        [scene.x + scene.width / 2, scene.y + scene.height / 2],
      );
      expect(over).toBe(-1);
      await expect.poll(() => cut(page)).toEqual([]);
      if (scene.width <= 760) {
        await page.getByRole('button', { name: 'About this view' }).click();
        await page.getByText('With ideal joints, this robot can only translate').waitFor();
        await page.getByRole('button', { name: 'Close this explanation' }).click();
      }
      // The panels are there, below where there is no room at the side, and in a drawer where there is none below.
      const drawer = page.getByTestId('drawer-right-button');
      if (await drawer.isVisible()) await drawer.click();
      await page.getByTestId('slider-tilt').scrollIntoViewIfNeeded();
      const slider = (await page.getByTestId('slider-tilt').boundingBox())!;
      expect(slider.width).toBeGreaterThan(60);
      expect(slider.x + slider.width).toBeLessThanOrEqual(width);
    }));

  test(`the cell and its time slider are visible in a window of ${width} × ${height}`, () =>
    at(width, height, 'cell', async (page) => {
      const scene = (await page.locator('.scene').boundingBox())!;
      expect(scene.width).toBeGreaterThanOrEqual(Math.min(width, 380));
      expect(scene.height).toBeGreaterThanOrEqual(200);
      const slider = (await page.getByTestId('cell-time').boundingBox())!;
      expect(slider.width).toBeGreaterThanOrEqual(100);
      await expect.poll(async () => (await page.getByLabel('Playback speed').boundingBox())!.width).toBeGreaterThanOrEqual(56);
      await expect.poll(() => cut(page)).toEqual([]);
    }));
}

for (const [width, height] of [[320, 568], [390, 844], [500, 900], [512, 350], [720, 450], [1024, 700]] as const)
  test(`nothing covers the platform of the robot in a window of ${width} × ${height}`, () =>
    at(width, height, 'robot', async (page) => {
      for (const view of ['first', 'Fit', 'Robot', 'Platform', 'Plan']) {
        if (view !== 'first') await page.getByRole('button', { name: view, exact: true }).last().click();
        await frames(page);
        const covered = await page.evaluate(() =>
          window.jointplay.probe.platform!().flatMap(({ x, y }) => {
            const over = document.elementFromPoint(x, y);
            return over?.matches('.scene canvas') ? [] : [`${x}, ${y}: ${over?.outerHTML.slice(0, 80)}`];
          }),
        );
        expect(covered, view).toEqual([]);
      }
    }));

for (const [width, height] of [[390, 844], [1024, 700], [1280, 720], [1440, 900], [1920, 1080]] as const) {
  test(`labels cover neither the platform nor each other in a window of ${width} × ${height}`, () =>
    at(width, height, 'robot', async (page) => {
      for (const view of ['Robot', 'Platform', 'Plan']) {
        await page.getByRole('button', { name: view, exact: true }).last().click();
        for (const model of ['polar', 'planar']) {
          await page.getByRole('radio', { name: model }).check();
          await until('the model is drawn', async () => page.getByRole('radio', { name: model }).isChecked());
          await frames(page, 8);
          const { labels, platform } = await page.evaluate(() => ({ labels: window.jointplay.probe.labels!(), platform: window.jointplay.probe.platform!() }));
          expect(labels.length, `${view}, ${model}: labels`).toBeGreaterThanOrEqual(3);
          labels.forEach((box, i) => {
            const { left, top, right, bottom } = box;
            // No corner and no middle of a side is within the convex outline of the platform: the outline is clockwise or counter-clockwise.
            for (const [x, y] of [[left, top], [right, top], [right, bottom], [left, bottom], [(left + right) / 2, top], [(left + right) / 2, bottom], [left, (top + bottom) / 2], [right, (top + bottom) / 2]] as const) {
              const sides = platform.map((from, k) => {
                const to = platform[(k + 1) % platform.length]!;
                return (to.x - from.x) * (y - from.y) - (to.y - from.y) * (x - from.x);
              });
              const inside = sides.every((side) => side > 1) || sides.every((side) => side < -1);
              expect(inside, `${view}, ${model}: label ${i} at ${JSON.stringify(box)} covers the platform`).toBe(false);
            }
            for (const { x, y } of platform) expect(x > left && x < right && y > top && y < bottom, `${view}, ${model}: label ${i}`).toBe(false);
            for (const other of labels.slice(i + 1)) expect(other.right <= left || right <= other.left || other.bottom <= top || bottom <= other.top, `${view}, ${model}: labels overlap`).toBe(true);
          });
        }
      }
    }));
}

test('nothing covers the platform in the low view above plots, also after the page was loaded again', () =>
  at(1280, 720, 'robot', async (page) => {
    await page.getByTestId('slider-tilt').fill('1');
    await until('a link to the pose', async () => page.url().includes('pose='));
    await reload(page);
    await drawn(page);
    await page.getByTestId('figure').selectOption('6');
    await until('samples', async () => Number(await page.getByTestId('sample').getAttribute('data-count')) > 0);
    await frames(page, 10);
    await expect.poll(async () => (await page.locator('.scene').boundingBox())!.height).toBeLessThanOrEqual(350);
    const buttons = (await page.locator('.views').boundingBox())!;
    const corners = await page.evaluate(() => window.jointplay.probe.platform!());
    expect(Math.min(...corners.map(({ y }) => y)), 'below the buttons').toBeGreaterThan(buttons.y + buttons.height);
  }));

test('the play scale can be moved next to the robot editor', () =>
  at(1024, 700, 'robot', async (page) => {
    await page.getByTestId('edit-robot').click();
    await page.getByTestId('robot-fields').waitFor();
    await expect.poll(async () => (await page.getByTestId('exaggeration').boundingBox())!.width).toBeGreaterThanOrEqual(60);
    const scene = (await page.locator('.scene').boundingBox())!;
    const scale = (await page.getByTestId('play-scale').boundingBox())!;
    expect(scale.x + scale.width).toBeLessThanOrEqual(scene.x + scene.width);
  }));

test('the platform fills the room between explanation and buttons', () =>
  at(1280, 720, 'robot', async (page) => {
    await page.getByRole('button', { name: 'Platform', exact: true }).click();
    await frames(page);
    const corners = (await page.evaluate(() => window.jointplay.probe.platform!())).map(({ x }) => x);
    const left = await page.locator('.introduction').evaluate((one) => one.getBoundingClientRect().right);
    const right = await page.locator('.views').evaluate((one) => one.getBoundingClientRect().left);
    expect(Math.min(...corners)).toBeGreaterThan(left);
    expect(Math.max(...corners)).toBeLessThan(right);
    expect(Math.max(...corners) - Math.min(...corners)).toBeGreaterThan(0.45 * (right - left));
    expect(Math.abs((Math.max(...corners) + Math.min(...corners) - left - right) / 2), 'in its middle').toBeLessThan(20);
  }));

test('no coordinate of the robot file is cut off, and nothing lengthens the page', () =>
  at(512, 350, 'robot', async (page) => {
    for (const [width, height] of [[512, 350], [1440, 900]] as const) {
      await page.setViewportSize({ width, height });
      if (!(await page.getByTestId('robot-fields').isVisible())) await page.getByTestId('edit-robot').click();
      await page.getByTestId('robot-fields').waitFor();
      const cut = () => page.getByTestId('robot-fields').locator('td input').evaluateAll((fields) => (fields as HTMLInputElement[]).filter((field) => field.scrollWidth > field.clientWidth).map(({ value }) => value));
      await expect.poll(async () => (await page.getByTestId('limb-2-y').inputValue()).length).toBeGreaterThan(8);
      await expect.poll(() => cut()).toEqual([]);
      await expect.poll(() => page.evaluate(() => document.body.scrollHeight)).toBe(height);
    }
  }));

test('the steps of the tour stay in view in a narrow window', () =>
  at(390, 844, 'robot', async (page) => {
    await page.getByRole('button', { name: 'About this view' }).click();
    const steps = page.getByTestId('tour-next').or(page.getByTestId('tour-end'));
    for (const outlined of ['section-pose', 'section-virtualization', null]) {
      await steps.click();
      await frames(page);
      const { x, y, width, height } = (await steps.boundingBox())!;
      expect(y + height).toBeLessThanOrEqual(844);
      await expect.poll(() => steps.evaluate((button, [x, y]) => button.contains(document.elementFromPoint(x!, y!)), [x + width / 2, y + height / 2])).toBe(true);
      if (outlined) await expect.poll(async () => (await page.locator(`#${outlined}`).boundingBox())!.y).toBeLessThan(700);
    }
    await steps.click();
    await expect.poll(() => steps.count()).toBe(0);
  }));

test('a file that is dropped on the robot view is opened, and does not replace the page', () =>
  at(1280, 720, 'robot', async (page) => {
    const drop = (name: string, bytes: number[]) =>
      page.evaluate(
        ([name, bytes]) => {
          const dataTransfer = new DataTransfer();
          dataTransfer.items.add(new File([Uint8Array.from(bytes)], name));
          const event = (type: string) => new DragEvent(type, { bubbles: true, cancelable: true, dataTransfer });
          const scene = document.querySelector('.scene')!;
          return [scene.dispatchEvent(event('dragover')), scene.dispatchEvent(event('drop'))];
        },
        [name, bytes] as const,
      );
    // An event whose default is not prevented makes the browser open the file.
    expect(await drop('picture.png', [0x89, 0x50, 0x4e, 0x47, 0xff])).toEqual([false, false]);
    await page.getByTestId('open-problem').filter({ hasText: 'picture.png is not a text file in UTF-8.' }).waitFor();
    const mechanism = readFileSync(resolve(ROOT, 'crates/jointplay-format/robots/four-bar.toml'));
    expect(await drop('mine.toml', [...mechanism])).toEqual([false, false]);
    await page.getByTestId('mechanism-name').filter({ hasText: 'Planar four-bar linkage' }).waitFor();
    await expect.poll(() => page.locator('dialog[open]').count()).toBe(0);
  }));

test('without a mechanism, one note replaces the panels, and the catalogue is one click away', () =>
  at(390, 844, 'mechanism', async (page) => {
    await page.getByTestId('dock-note').waitFor();
    await expect.poll(() => page.getByTestId('dock-note').count()).toBe(1);
    await expect.poll(() => page.locator('[data-dock] section').count()).toBe(0);
    await page.getByTestId('show-catalogue').click();
    const entry = page.getByTestId('entry-four-bar');
    await entry.click();
    await page.getByTestId('mechanism-name').filter({ hasText: 'Planar four-bar linkage' }).waitFor();
    await until('the mechanism is in view', async () => ((await page.locator('.scene').boundingBox())!.y) > 0);
    await expect.poll(() => page.locator('[data-dock] section').count()).toBeGreaterThan(5);
  }));

for (const [width, height] of [[320, 568], [390, 844], [512, 350], [720, 450]] as const)
  test(`the note of an empty mechanism view is next to the cube in a window of ${width} × ${height}`, () =>
    at(width, height, 'mechanism', async (page) => {
      const button = (await page.getByTestId('show-catalogue').boundingBox())!;
      const lines = await page.locator('.empty').evaluate((note) => {
        const range = document.createRange();
        range.selectNode(note.firstChild!);
        return [...range.getClientRects()].map(({ x, y, width, height }) => ({ x, y, width, height }));
      });
      expect(lines.length).toBeGreaterThan(0);
      const scene = (await page.locator('.scene').boundingBox())!;
      const cube = await page.getByTestId('cube').boundingBox();
      for (const box of [button, ...lines]) {
        expect(box.x).toBeGreaterThanOrEqual(scene.x);
        expect(box.x + box.width).toBeLessThanOrEqual(scene.x + scene.width);
        expect(box.y + box.height).toBeLessThanOrEqual(scene.y + scene.height);
        if (cube) expect(box.x + box.width <= cube.x || box.x >= cube.x + cube.width || box.y >= cube.y + cube.height || box.y + box.height <= cube.y, JSON.stringify({ box, cube })).toBe(true);
      }
    }));

test('a mechanism of the catalogue is in view after it is opened from the drawer of a small window', () =>
  at(512, 350, 'mechanism', async (page) => {
    await page.getByTestId('show-catalogue').click();
    await page.getByTestId('entry-four-bar').click();
    await page.getByTestId('mechanism-name').filter({ hasText: 'Planar four-bar linkage' }).waitFor();
    await page.locator('#drawer-left').waitFor({ state: 'hidden' });
    await expect.poll(() => page.getByTestId('drawer-left-button').evaluate((button) => button === document.activeElement)).toBe(true);
  }));

test('a loading note is visible before the scripts have loaded', async () => {
  await expect.poll(async () => await (await fetch(server.address)).text()).toContain('Loading the studio');
  await at(1280, 720, 'robot', async (page) => expect(await page.getByText('Loading the studio').count()).toBe(0));
});

test('on a phone, a chosen violation is in the picture, which stays in view', async () => {
  const text = readFileSync(join(folder, 'mine.toml'), 'utf8');
  const file = join(folder, 'blocked.toml');
  writeFileSync(file, text.replace('position_mm = [100.0, -600.0, 500.0]', 'position_mm = [-330.0, 330.0, 500.0]'));
  writeFileSync(join(folder, 'blocked.program'), `${'# a comment\n'.repeat(30)}HOME\nGET LP1 SLOT 1 WITH A\nPUT ALIGN WITH A\nHOME\n`);
  const blocked = await serve(0, ['--cell', file]);
  const page = await visit(browser, { viewport: { width: 390, height: 844 } });
  try {
    await page.addInitScript(() => sessionStorage.setItem('jointplay.studio.part', 'cell'));
    await load(page, blocked.address);
    const violation = page.getByTestId('violations').getByRole('button').first();
    await violation.scrollIntoViewIfNeeded();
    await violation.click();
    const inView = async () => {
      const { y, height } = (await page.locator('.scene').boundingBox())!;
      return y >= -1 && y + height <= 845;
    };
    await until('the picture is in view', inView);
    await frames(page);
    await expect.poll(() => inView()).toBe(true);
  } finally {
    await page.context().close();
    await blocked.stop();
  }
});
