// Arms and effectors added, duplicated and deleted by button and by keyboard; a robot in a file of its own.

import { copyFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { afterAll, afterEach, beforeAll, expect, test } from 'vitest';
import type { Page } from 'playwright-core';
import { EXAMPLE_CELL, ROOT, accessibilityViolations, cellFixture, complaints, load, partNames, unhandled, until, visit, waitForCheck, type CellFixture } from './studio';

let fixture: CellFixture;
let page: Page;
let heard: string[];

beforeAll(async () => {
  fixture = await cellFixture('HOME\nGET LP1 SLOT 1 WITH B\nPUT ALIGN WITH B\nHOME\n');
  page = await visit(fixture.browser, { viewport: { width: 1440, height: 900 } });
  heard = complaints(page);
  await load(page, fixture.server.address);
  await waitForCheck(page, 'passed');
  await until('the cell is drawn', async () => (await partNames(page)).length > 0);
  await page.getByRole('tab', { name: 'Parts' }).click();
});
afterAll(() => fixture?.close());
afterEach(() => {
  expect(unhandled(heard.splice(0))).toEqual([]);
});

const tree = () => page.getByTestId('parts');
const arm = (name: string) => tree().getByRole('button', { name: `${name} whole arm` });
const effector = (name: string) => tree().getByRole('button', { name: `${name} effector`, exact: true });
const button = (id: string) => page.getByTestId(id);
/** Opens the list of an arm. */
const open = async (name: string) => {
  const list = tree().locator('details.inner').filter({ has: page.locator('summary', { hasText: new RegExp(`^Arm ${name}$`) }) });
  if ((await list.getAttribute('open')) === null) await list.locator('summary').click();
};
const undo = () => page.locator('.files').getByRole('button', { name: 'Undo' }).click();
const cellText = async () => {
  await page.getByRole('tab', { name: /^Cell file/ }).click();
  await page.getByTestId('text-cell').locator('.cm-content').click();
  await page.keyboard.press('Control+a');
  await page.context().grantPermissions(['clipboard-read', 'clipboard-write']);
  await page.keyboard.press('Control+c');
  const text = await page.evaluate(() => navigator.clipboard.readText());
  await page.getByRole('tab', { name: 'Parts' }).click();
  return text;
};
const drawn = (name: string, is = true) => until(`${name} is ${is ? '' : 'not '}drawn`, async () => (await partNames(page)).includes(name) === is);
/** Moves the focus by the Tab key to an element. */
async function tabTo(id: string, key = 'Tab') {
  for (let k = 0; k < 400; k += 1) {
    if ((await page.evaluate(() => (document.activeElement as HTMLElement | null)?.dataset.testid)) === id) return;
    await page.keyboard.press(key);
  }
  throw new Error(`the Tab key does not reach ${id}`);
}

test('an arm is deleted with its bodies, another one is added, and all is undone', async () => {
  // Two arms are the largest number.
  await expect.poll(() => button('add-arm').isDisabled()).toBe(true);
  await expect.poll(() => button('add-arm').getAttribute('title')).toContain('at most 2');
  await open('upper');
  await arm('upper').click();
  await expect.poll(() => button('part-duplicate').isDisabled()).toBe(true);
  await button('part-delete').click();
  await drawn('blade-A', false);
  await waitForCheck(page, 'passed');
  await expect.poll(() => button('add-arm').isEnabled()).toBe(true);
  // The last arm cannot be deleted.
  await open('lower');
  await arm('lower').click();
  await expect.poll(() => button('part-delete').isDisabled()).toBe(true);
  await expect.poll(() => button('part-delete').getAttribute('title')).toContain('at least one arm');
  await button('add-arm').click();
  await drawn('arm-1-blade');
  await waitForCheck(page, 'passed');
  await until('it is selected', async () => (await arm('arm-1').getAttribute('aria-pressed')) === 'true');
  const text = await cellText();
  expect(text).toContain('[robot]');
  // The comment directly above a deleted body is deleted with it.
  for (const line of EXAMPLE_CELL.split('\n').filter((line) => line.trim().startsWith('#') && !line.startsWith('# Links of an arm'))) expect(text).toContain(line);
  await expect.poll(() => accessibilityViolations(page)).toEqual([]);
  await undo();
  await drawn('arm-1-blade', false);
  await undo();
  await drawn('blade-A');
  await expect.poll(() => cellText()).toBe(EXAMPLE_CELL);
  await waitForCheck(page, 'passed');
});

test('an arm and an effector are duplicated and deleted by the keyboard alone', async () => {
  await open('upper');
  await arm('upper').focus();
  await page.keyboard.press('Enter');
  await tabTo('part-delete');
  await page.keyboard.press('Enter');
  await drawn('blade-A', false);
  await waitForCheck(page, 'passed');
  await open('lower');
  await arm('lower').focus();
  await page.keyboard.press('Space');
  await tabTo('part-duplicate');
  await page.keyboard.press('Enter');
  await drawn('blade-B2');
  await waitForCheck(page, 'passed');
  await open('lower2');
  await effector('B2').focus();
  await page.keyboard.press('Enter');
  await tabTo('part-duplicate');
  await page.keyboard.press('Enter');
  await effector('B3').waitFor();
  await waitForCheck(page, 'passed');
  await until('it is selected', async () => (await effector('B3').getAttribute('aria-pressed')) === 'true');
  await tabTo('part-delete');
  await page.keyboard.press('Enter');
  await until('B3 is deleted', async () => (await effector('B3').count()) === 0);
  await arm('lower2').focus();
  await page.keyboard.press('Enter');
  await tabTo('part-delete');
  await page.keyboard.press('Enter');
  await drawn('blade-B2', false);
  await tabTo('add-arm');
  await page.keyboard.press('Enter');
  await drawn('arm-1-blade');
  for (let k = 0; k < 6; k += 1) {
    await waitForCheck(page, 'passed');
    await undo();
  }
  await drawn('blade-A');
  await expect.poll(() => cellText()).toBe(EXAMPLE_CELL);
});

test('an effector is added to an arm by the keyboard alone, and removed by undo', async () => {
  await waitForCheck(page, 'passed');
  await open('upper');
  await arm('upper').focus();
  await tabTo('add-effector-upper');
  await page.keyboard.press('Enter');
  await drawn('A2-blade');
  await waitForCheck(page, 'passed');
  await until('it is selected', async () => (await effector('A2').getAttribute('aria-pressed')) === 'true');
  await expect.poll(() => button('part-delete').isEnabled()).toBe(true);
  const text = await cellText();
  for (const line of EXAMPLE_CELL.split('\n').filter((line) => line.trim().startsWith('#'))) expect(text).toContain(line);
  await expect.poll(() => accessibilityViolations(page)).toEqual([]);
  // Four effectors are the largest number.
  for (const name of ['A3', 'A4']) {
    await open('upper');
    await button('add-effector-upper').click();
    await drawn(`${name}-blade`);
    await waitForCheck(page, 'passed');
  }
  await expect.poll(() => button('add-effector-upper').isDisabled()).toBe(true);
  await expect.poll(() => button('add-effector-upper').getAttribute('title')).toContain('at most 4');
  for (let k = 0; k < 3; k += 1) {
    await waitForCheck(page, 'passed');
    await undo();
  }
  await drawn('A2-blade', false);
  await expect.poll(() => cellText()).toBe(EXAMPLE_CELL);
  await waitForCheck(page, 'passed');
});

test('the arms of a robot in a file of its own are not changed, with the reason', async () => {
  copyFileSync(join(ROOT, 'crates/jointplay-format/robots/radial-arm.toml'), join(fixture.folder, 'my-arm.toml'));
  writeFileSync(fixture.cellFile, 'kind = "cell"\nname = "One arm"\nrobot = "my-arm.toml"\nwafer = { diameter_mm = 300, thickness_mm = 0.775, material = "silicon" }\nbudgets = { virtual_joint_norm_um = 60, min_distance_mm = 1, slot_min_distance_mm = 1, plane_urad = 20 }\nstation = [{ name = "P", position_mm = [600, 0, 560], heading_deg = -90, stroke = { below_mm = 4, above_mm = 3, speed_mm_s = 20 }, retract_mm = 10 }]\n');
  writeFileSync(fixture.programFile, 'HOME\n');
  const other = await visit(fixture.browser, { viewport: { width: 1440, height: 900 } });
  await load(other, fixture.server.address);
  await waitForCheck(other, 'no_motion');
  await other.getByRole('tab', { name: 'Parts' }).click();
  const add = other.getByTestId('add-arm');
  await expect.poll(() => add.isDisabled()).toBe(true);
  await expect.poll(() => add.getAttribute('title')).toContain('my-arm.toml');
  await other.getByTestId('parts').locator('details.inner summary').click();
  await expect.poll(() => other.getByTestId('add-effector-arm').isDisabled()).toBe(true);
  await expect.poll(() => other.getByTestId('add-effector-arm').getAttribute('title')).toContain('my-arm.toml');
  for (const name of ['arm whole arm', 'A effector']) {
    await other.getByTestId('parts').getByRole('button', { name, exact: true }).click();
    await expect.poll(() => other.getByTestId('part-duplicate').isDisabled()).toBe(true);
    await expect.poll(() => other.getByTestId('part-delete').isDisabled()).toBe(true);
    await expect.poll(() => other.getByTestId('part-delete').getAttribute('title')).toContain('my-arm.toml');
  }
  await other.close();
});
