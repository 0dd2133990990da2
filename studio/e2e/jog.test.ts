// Jogging: the check of each pose, the stop at contact, and teaching in contact.

import type { Page } from 'playwright-core';
import { afterAll, afterEach, beforeAll, expect, test } from 'vitest';
import { accessibilityViolations, cellFixture, complaints, load, partNames, unhandled, until, visit, type CellFixture } from './studio';

const NOTE = '# Taught in contact: ';

let fixture: CellFixture;
let page: Page;
let heard: string[];

beforeAll(async () => {
  fixture = await cellFixture();
  page = await visit(fixture.browser);
  heard = complaints(page);
  await load(page, fixture.server.address);
});
afterAll(() => fixture?.close());
afterEach(() => {
  expect(heard.splice(0)).toEqual([]);
});

const value = async (name: string) => Number(await page.getByTestId(`field-jog-${name}`).inputValue());
async function set(name: string, to: number): Promise<void> {
  await page.getByTestId(`field-jog-${name}`).fill(String(to));
  await page.getByTestId(`field-jog-${name}`).press('Enter');
}
const state = (want: string) => until(`the pose is ${want}`, async () => (await page.getByTestId('jog-check').getAttribute('data-state')) === want);
const marked = () => page.evaluate(() => window.jointplay.probe.cell!.violating());
const text = () => page.getByTestId('text-cell').locator('.cm-content').innerText();
/** Blade A turned toward the wall and stretched through it. */
async function intoTheWall(): Promise<void> {
  await set('T', -90);
  await until('it turned', async () => (await value('T')) === -90);
  await state('passed');
  await set('RA', 60);
}

test('a jogged pose without contact lists its minimum distances and highlights nothing', async () => {
  await until('the cell is drawn', async () => (await partNames(page)).length > 0);
  await state('passed');
  await expect.poll(() => page.getByTestId('jog-stop').isChecked(), { message: 'the safe choice is the first' }).toBe(true);
  const rows = await page.getByTestId('jog-distances').locator('td:last-child').allTextContents();
  const distances = rows.map((row) => Number(/^([\d.]+) mm$/.exec(row)![1]));
  expect(distances.length).toBeGreaterThan(0);
  expect(distances).toEqual([...distances].sort((a, b) => a - b));
  await expect.poll(() => marked()).toEqual([]);
});

test('with "Stop at contact" the robot stops before the wall', async () => {
  await intoTheWall();
  await page.getByTestId('jog-stopped').filter({ hasText: 'wall' }).filter({ hasText: 'would touch' }).waitFor();
  await expect.poll(() => value('RA')).toBeGreaterThan(-40);
  await expect.poll(() => value('RA')).toBeLessThan(59);
  // It does not touch, but is nearer than the clearance that the cell asks for.
  await state('violations');
  await page.getByTestId('jog-violations').filter({ hasText: 'wall' }).waitFor();
  await expect.poll(() => marked()).toEqual([]);
});

test('a blade in contact with the wall is a violation, and both are highlighted', async () => {
  await page.getByTestId('jog-stop').uncheck();
  await set('RA', 60);
  await until('it is in the wall', async () => (await value('RA')) === 60);
  await state('violations');
  await expect.poll(() => page.getByTestId('jog-stopped').innerText()).toBe('');
  await page.getByTestId('jog-violations').locator('li', { hasText: 'blade-A' }).filter({ hasText: 'wall' }).waitFor();
  await page.getByTestId('jog-distances').locator('tr', { hasText: 'wall' }).filter({ hasText: 'contact' }).first().waitFor();
  await page.getByTestId('current-violations').filter({ hasText: 'wall' }).waitFor();
  for (const name of ['wall', 'blade-A']) await expect.poll(() => marked()).toContain(`body:${name}`);
  if (process.env.SCREENSHOT) await page.screenshot({ path: process.env.SCREENSHOT });
  await expect.poll(() => accessibilityViolations(page)).toEqual([]);
});

test('the check of the pose is outdated while a newer response is pending', async () => {
  const held: (() => void)[] = [];
  await page.route('**/cell/jog', async (route) => {
    await new Promise<void>((go) => held.push(go));
    await route.continue();
  });
  await page.getByRole('button', { name: 'Decrease RA by 1 °' }).click();
  await state('outdated');
  await expect.poll(() => page.getByTestId('jog-check').innerText()).toContain('Outdated');
  await expect.poll(() => page.evaluate(() => window.jointplay.probe.cell!.violationColor()), { message: 'the marks lose their colour' }).toBe('8a9099');
  await until('the answer is there', async () => {
    for (const go of held.splice(0)) go();
    return (await page.getByTestId('jog-check').getAttribute('data-state')) === 'violations';
  });
  await page.unroute('**/cell/jog');
  await expect.poll(() => page.evaluate(() => window.jointplay.probe.cell!.violationColor())).toBe('d62f1f');
  await expect.poll(() => value('RA')).toBe(59);
});

test('teaching in contact requires a confirmation and adds a comment to the file', async () => {
  const teach = page.getByTestId('teach-LP2-position');
  await page.locator('summary', { hasText: 'LP2' }).click();
  await teach.click();
  const asked = page.getByTestId('contact-LP2');
  await asked.filter({ hasText: 'wall' }).filter({ hasText: 'blade-A' }).waitFor();
  await expect.poll(() => page.getByTestId('save').isDisabled(), { message: 'nothing is changed' }).toBe(true);
  await asked.getByRole('button', { name: 'Cancel' }).click();
  await until('the question is closed', async () => (await asked.count()) === 0);
  await expect.poll(() => page.getByTestId('save').isDisabled()).toBe(true);
  // The question is about this pose: another one withdraws it.
  await teach.click();
  await asked.waitFor();
  await set('RA', 58);
  await until('the question is closed', async () => (await asked.count()) === 0);
  await teach.click();
  await page.getByTestId('contact-confirm').click();
  await page.getByTestId('text-cell').locator('.cm-line', { hasText: NOTE }).filter({ hasText: 'wall' }).waitFor();
  await until('it can be saved', () => page.getByTestId('save').isEnabled());
  expect(unhandled(heard.splice(0))).toEqual([]);
  await page.getByRole('button', { name: 'Undo' }).click();
  await until('one step takes it back', async () => !(await text()).includes(NOTE) && (await page.getByTestId('save').isDisabled()));
});

test('a plane point taught in contact requires a confirmation, and its comment stays with later points', async () => {
  await state('violations');
  await page.getByTestId('teach-ALIGN-point').evaluate((button: HTMLElement) => button.closest('details')!.querySelector('summary')!.click());
  await page.getByTestId('teach-ALIGN-point').click();
  await page.getByTestId('contact-ALIGN').filter({ hasText: 'wall' }).waitFor();
  await expect.poll(() => page.getByTestId('points-ALIGN').count(), { message: 'no point is taken yet' }).toBe(0);
  await page.getByTestId('contact-confirm').click();
  await until('the point is taken', async () => (await page.getByTestId('points-ALIGN').locator('li').count()) === 1);
  await page.getByTestId('text-cell').locator('.cm-line', { hasText: NOTE }).waitFor();
  await set('RA', 20);
  await until('it is out of the wall', async () => (await value('RA')) === 20 && (await page.getByTestId('jog-check').getAttribute('data-state')) === 'passed');
  await page.getByTestId('teach-ALIGN-point').click();
  await until('the second point is taken', async () => (await page.getByTestId('points-ALIGN').locator('li').count()) === 2);
  await expect.poll(() => text()).toContain(NOTE);
  expect(unhandled(heard.splice(0))).toEqual([]);
});

test('a station is taught by the requested pose while its response is pending', async () => {
  const held: (() => void)[] = [];
  await page.route('**/cell/jog', async (route) => {
    await new Promise<void>((go) => held.push(go));
    await route.continue();
  });
  await set('RA', 60);
  await state('outdated');
  await page.getByTestId('teach-ALIGN-point').click();
  await until('the question is there', async () => {
    for (const go of held.splice(0)) go();
    return (await page.getByTestId('contact-ALIGN').count()) === 1;
  });
  await page.unroute('**/cell/jog');
  await expect.poll(() => page.getByTestId('points-ALIGN').locator('li').count()).toBe(2);
  expect(unhandled(heard.splice(0))).toEqual([]);
});
