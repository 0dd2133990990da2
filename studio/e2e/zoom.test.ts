// Small windows, as at 200 % zoom: panels and texts are drawers, every control can be used, and nothing covers it.

import { mkdirSync } from 'node:fs';
import { join } from 'node:path';
import type { Page } from 'playwright-core';
import { afterAll, afterEach, beforeAll, expect, test } from 'vitest';
import { accessibilityViolations, cellFixture, complaints, drawn, frames, load, unhandled, until, visit, waitForCheck, type CellFixture } from './studio';

let fixture: CellFixture;
let page: Page;
let heard: string[] = [];

beforeAll(async () => {
  fixture = await cellFixture();
});
afterAll(() => fixture?.close());
afterEach(async () => {
  await page?.context().close();
  expect(unhandled(heard.splice(0))).toEqual([]);
});

type View = 'robot' | 'mechanism' | 'cell';
async function at(width: number, height: number, view: View): Promise<void> {
  page = await visit(fixture.browser, { viewport: { width, height }, deviceScaleFactor: process.env.SCREENSHOTS ? 1 : 0.5 });
  heard = complaints(page);
  await page.addInitScript((shown) => localStorage.setItem('jointplay.studio.part', JSON.stringify(shown)), view);
  await load(page, fixture.server.address);
  if (view === 'robot') await drawn(page);
  else await waitForCheck(page, 'passed');
  if (view !== 'mechanism') return;
  await page.getByRole('button', { name: 'Mechanism', exact: true }).click();
  await page.getByTestId('entry-four-bar').waitFor({ state: 'attached' });
}

/** Stores a picture, if they are requested. */
async function picture(name: string): Promise<void> {
  const folder = process.env.SCREENSHOTS;
  if (!folder) return;
  mkdirSync(folder, { recursive: true });
  await frames(page);
  const { width, height } = page.viewportSize()!;
  await page.screenshot({ path: join(folder, `${name}-${width}x${height}.png`) });
}

/** Controls in a part of the page that have no size, are cut off, or are covered by another element after the page has scrolled to them. */
const unusable = (part = 'body') =>
  page.evaluate((part) => {
    const found: string[] = [];
    for (const control of document.querySelectorAll<HTMLElement>(`${part} :is(button, select, input, summary, a[href])`)) {
      if (control.matches('.visually-hidden') || control.closest('[hidden], dialog:not([open]), details:not([open]) > :not(summary)')) continue;
      if (getComputedStyle(control).visibility === 'hidden' || !control.checkVisibility()) continue;
      control.scrollIntoView({ block: 'center', inline: 'nearest' });
      const { left, top, width, height } = control.getBoundingClientRect();
      const name = `${control.tagName} ${control.getAttribute('aria-label') ?? control.textContent!.trim() ?? control.id}`;
      const [x, y] = [left + width / 2, top + height / 2];
      const over = document.elementFromPoint(x, y);
      if (width < 8 || height < 8) found.push(`${name}: ${width} × ${height}`);
      else if (left < -0.5 || left + width > window.innerWidth + 0.5) found.push(`${name}: from ${left} to ${left + width}`);
      else if (!over || !(control.contains(over) || over.contains(control))) found.push(`${name}: under ${over?.outerHTML.slice(0, 80)}`);
    }
    window.scrollTo(0, 0);
    for (const scrolled of document.querySelectorAll('*')) scrolled.scrollTop = 0;
    return found;
  }, part);

/** Joints of the shown mechanism that are outside of the view, or under its legend, title or buttons. */
const coveredJoints = () =>
  page.evaluate(() => {
    const { mechanism } = window.jointplay.probe;
    const scene = document.querySelector('.scene')!.getBoundingClientRect();
    const over = [...document.querySelectorAll('[aria-label=Legend], [data-testid=mechanism-name], [role=group][aria-label=Views] button')];
    return Object.keys(mechanism!.joints()).flatMap((joint) => {
      const { x, y } = mechanism!.onPage(joint)!;
      const isOver = ({ left, right, top, bottom }: DOMRect) => x > left && x < right && y > top && y < bottom;
      if (!isOver(scene)) return [`${joint} is outside of the view`];
      return over.filter((one) => isOver(one.getBoundingClientRect())).map((one) => `${joint} is under ${one.textContent!.trim()}`);
    });
  });

/** Checks the page: no rule of accessibility is violated, nothing scrolls sideways, and each control can be used. */
async function good(name: string, part = 'body'): Promise<void> {
  await picture(name);
  await expect.poll(() => unusable(part), { message: name }).toEqual([]);
  await expect.poll(() => page.evaluate(() => document.documentElement.scrollWidth), { message: name }).toBeLessThanOrEqual(page.viewportSize()!.width);
  await expect.poll(() => accessibilityViolations(page), { message: name }).toEqual([]);
}

/** Opens a drawer by the keyboard, checks it, and closes it. */
async function drawer(side: 'left' | 'right', name: string, does: () => Promise<void> = async () => {}): Promise<void> {
  const button = page.getByTestId(`drawer-${side}-button`);
  const opened = page.locator(`#drawer-${side}`);
  await expect.poll(() => opened.isVisible(), { message: name }).toBe(false);
  await button.focus();
  await page.keyboard.press('Enter');
  await opened.waitFor();
  await until('the focus is in the drawer', () => opened.evaluate((one) => one.contains(document.activeElement)));
  await does();
  // A part of the view remains visible.
  await expect.poll(async () => (await opened.boundingBox())!.width).toBeLessThanOrEqual(0.75 * page.viewportSize()!.width);
  await good(name, `#drawer-${side}`);
  await page.keyboard.press('Escape');
  await until('it is closed', async () => !(await opened.isVisible()));
  await expect.poll(() => button.evaluate((one) => one === document.activeElement), { message: 'the focus returns' }).toBe(true);
}

for (const [width, height] of [[720, 450], [512, 350]] as const) {
  const size = `in a window of ${width} × ${height}`;

  test(`the robot view and its panels ${size}`, async () => {
    await at(width, height, 'robot');
    const scene = (await page.locator('.scene').boundingBox())!;
    expect(scene.width).toBe(width);
    expect(scene.height).toBeGreaterThan(190);
    await good('robot');
    await drawer('right', 'robot-panels');
    await page.getByTestId('motion').selectOption('serpentine');
    await until('the samples', async () => Number(await page.getByTestId('sample').getAttribute('data-count')) > 100);
    await good('robot-motion');
  });

  test(`the editor of the robot ${size}`, async () => {
    await at(width, height, 'robot');
    await page.getByTestId('edit-robot').click();
    const editor = page.getByTestId('robot-editor');
    await editor.locator('input').first().waitFor();
    await expect.poll(async () => (await editor.boundingBox())!.height).toBeGreaterThan(200);
    await good('editor', '[data-testid=robot-editor]');
    await page.getByTestId('edit-robot').click();
    await until('it is closed', async () => (await editor.count()) === 0);
  });

  test(`the dialog to open files ${size}`, async () => {
    await at(width, height, 'robot');
    await page.getByTestId('open').click();
    await page.getByTestId('sample-four-bar').waitFor();
    await good('open', 'dialog[open]');
  });

  test(`the view of mechanisms, its texts and its panels ${size}`, async () => {
    await at(width, height, 'mechanism');
    await drawer('left', 'mechanism-texts', async () => {
      await page.getByTestId('entry-four-bar').click();
      await page.getByTestId('mechanism-name').filter({ hasText: 'Four-bar linkage' }).waitFor();
    });
    await good('mechanism');
    await drawer('right', 'mechanism-panels');
  });

  test(`nothing covers a joint of a mechanism ${size}`, async () => {
    await at(width, height, 'mechanism');
    const names = await page.locator('[data-testid^=entry-]').evaluateAll((entries) => entries.map((one) => (one as HTMLElement).dataset.testid!.slice('entry-'.length)));
    expect(names.length).toBeGreaterThan(20);
    const covered: string[] = [];
    for (const name of names) {
      // The drawer of the catalogue stays closed: it would cover the view.
      await page.locator('#mechanism-tab-catalogue').evaluate((tab: HTMLElement) => tab.click());
      await page.getByTestId(`entry-${name}`).waitFor({ state: 'attached' });
      await page.getByTestId(`entry-${name}`).evaluate((entry: HTMLElement) => entry.click());
      await until(`${name} is drawn`, () => page.evaluate((name) => document.querySelector('.files .file')?.textContent?.replace(/\.toml$/, '') === name && document.querySelector('[aria-label=Legend]') !== null, name));
      await frames(page, 4);
      covered.push(...(await coveredJoints()).map((joint) => `${name}: ${joint}`));
    }
    expect(covered).toEqual([]);
  });

  test(`the cell view, its texts and its panels ${size}`, async () => {
    await at(width, height, 'cell');
    await expect.poll(async () => (await page.locator('.scene').boundingBox())!.height).toBeGreaterThan(190);
    await good('cell');
    for (const tab of ['Steps', 'Parts', 'Cell file', 'Program'])
      await drawer('left', `cell-${tab.toLowerCase().replace(' ', '-')}`, () => page.getByRole('tab', { name: tab }).click());
    await drawer('right', 'cell-panels');
    await page.getByTestId('cell-plots-toggle').click();
    await good('cell-plots');
  });
}

test('a line that a violation refers to is shown in the drawer of the texts', async () => {
  await at(720, 450, 'cell');
  await page.getByTestId('drawer-left-button').click();
  await page.getByTestId('text-program').locator('.cm-content').click();
  await page.keyboard.press('Control+a');
  await page.keyboard.insertText('HOME\nMOVE T -90 deg RA 60 deg\nHOME\n');
  // In the editor, Escape leaves it, and the drawer remains.
  await page.keyboard.press('Escape');
  await expect.poll(() => page.locator('#drawer-left').isVisible()).toBe(true);
  await page.getByTestId('drawer-right-button').click();
  await until('only one drawer is open', async () => !(await page.locator('#drawer-left').isVisible()));
  const violation = page.getByTestId('violations').getByRole('button').first();
  await violation.waitFor();
  await violation.click();
  await until('the text is shown', () => page.locator('#drawer-left').isVisible());
});
