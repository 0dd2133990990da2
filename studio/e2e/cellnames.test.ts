// Parts of a cell that share their names: names are unique within one kind only.

import { afterAll, afterEach, beforeAll, expect, test } from 'vitest';
import type { Page } from 'playwright-core';
import { EXAMPLE_CELL, cellFixture, complaints, load, partNames, unhandled, until, visit, waitForCheck, type CellFixture } from './studio';

/** Boxes outside of the reach, named like a station, an arm, an effector, an axis and a zone. */
const NAMES = ['LP1', 'upper', 'A', 'T', 'optics'];
/** A zone out of reach, named like the body that a jogged arm touches. */
const FAR_ZONE = '\n[[zone]]\nname = "wall"\nrule = "keep-out"\nposition_mm = [1500.0, 600.0, 100.0]\nbox = { size_mm = [100.0, 100.0, 100.0] }\n';
const CELL = EXAMPLE_CELL + NAMES.map((name, k) => `\n[[body]]\nname = "${name}"\nposition_mm = [${1500 + 200 * k}.0, 0.0, 100.0]\nbox = { size_mm = [100.0, 100.0, 100.0] }\n`).join('') + FAR_ZONE;

let fixture: CellFixture;
let page: Page;
let heard: string[];

beforeAll(async () => {
  fixture = await cellFixture(undefined, CELL);
  page = await visit(fixture.browser, { viewport: { width: 1440, height: 900 } });
  heard = complaints(page);
  await load(page, fixture.server.address);
  await waitForCheck(page, 'passed');
  await until('the cell is drawn', async () => (await partNames(page)).length > 0);
  await page.getByRole('tab', { name: 'Parts' }).click();
  for (const list of ['Zones', 'Bodies']) await group(list).locator('summary').first().click();
});
afterAll(() => fixture?.close());
afterEach(() => {
  expect(unhandled(heard.splice(0))).toEqual([]);
});

const group = (title: string) => page.getByTestId('parts').locator('details').filter({ has: page.locator('summary', { hasText: new RegExp(`^${title}`) }) }).first();
const part = (list: string, name: string) => group(list).getByRole('button', { name: new RegExp(`^${name}( \\d+ slots| keep-out)?$`) });
const selected = () => page.evaluate(() => window.jointplay.probe.cell!.selected());
const shown = () => page.evaluate(() => window.jointplay.probe.cell!.shown());

test('each part is selected alone, described and highlighted by its kind', async () => {
  for (const name of NAMES) {
    await part('Bodies', name).click();
    await until(`the body ${name} is highlighted`, async () => (await selected()).join() === name);
    await page.getByTestId('properties').filter({ hasText: 'Attached to' }).waitFor();
    await expect.poll(() => page.getByTestId('parts').locator('button[aria-pressed=true]').count(), { message: name }).toBe(1);
    await expect.poll(() => page.evaluate(() => window.jointplay.probe.cell!.grip('height' as never)), { message: `${name} has no handles of a station` }).toBeNull();
  }
  await part('Stations', 'LP1').click();
  await until('the slots and the bodies of the station are highlighted', async () => (await selected()).filter((name) => /^LP1 \d+$/.test(name)).length === 25 && (await selected()).includes('LP1-back'));
  await expect.poll(() => selected()).not.toContain('LP1');
  await page.getByTestId('properties').filter({ hasText: 'Heading' }).waitFor();
  await part('Zones', 'optics').click();
  await page.getByTestId('properties').filter({ hasText: 'no body enters' }).waitFor();
  await expect.poll(() => part('Bodies', 'optics').getAttribute('aria-pressed')).toBe('false');
});

test('a link selects the part of its kind', async () => {
  await part('Bodies', 'LP1').click();
  await page.getByRole('button', { name: 'Copy link' }).click();
  await until('the link has the selection', () => page.evaluate(() => window.location.hash.includes('selected=body%3ALP1')));
  const other = await visit(fixture.browser);
  await load(other, page.url());
  await until('the body is selected', async () => (await other.evaluate(() => window.jointplay.probe.cell?.selected() ?? [])).join() === 'LP1');
  await other.context().close();
});

test('hiding and deleting a body leaves the station of its name', async () => {
  // The body is selected still.
  await page.getByTestId('part-hide').click();
  await until('the body is hidden', async () => !(await shown()).includes('LP1'));
  await expect.poll(() => shown()).toContain('LP1 1');
  await page.getByTestId('show-all').click();
  await page.getByTestId('part-delete').click();
  await until('the body is deleted', async () => (await part('Bodies', 'LP1').count()) === 0);
  await waitForCheck(page, 'passed');
  await expect.poll(() => part('Stations', 'LP1').count()).toBe(1);
});

test('an isolated station keeps its bodies', async () => {
  await part('Stations', 'LP2').click();
  await page.getByTestId('part-isolate').click();
  const parts = (station: string) => [...Array.from({ length: 25 }, (_, k) => `${station} ${k + 1}`), 'LP2-back', 'LP2-floor', 'LP2-left', 'LP2-port', 'LP2-right'].sort().join();
  await until('the station is shown alone', async () => (await shown()).sort().join() === parts('LP2'));
  await page.getByTestId('show-all').click();
});

test('an arm is hidden with the bodies on its links, and an isolated link keeps them', async () => {
  await group('Robot').getByText('Arm upper').click();
  await part('Robot', 'upper whole arm').click();
  await page.getByTestId('part-hide').click();
  await until('the arm is hidden', async () => !(await shown()).includes('blade-A'));
  const names = await shown();
  for (const name of ['hub', 'forearm-A', 'upper link 1']) expect(names).not.toContain(name);
  // The body with the name of the arm is no part of it.
  for (const name of ['blade-B', 'upper']) expect(names).toContain(name);
  await page.getByTestId('show-all').click();
  await part('Robot', 'upper link 4').click();
  await page.getByTestId('part-isolate').click();
  await until('the last link is shown alone', async () => (await shown()).sort().join() === 'blade-A,bracket-A,post-A');
  await page.getByTestId('show-all').click();
});

test('a contact highlights the touching parts, and no other part with the name of one', async () => {
  const violating = () => page.evaluate(() => window.jointplay.probe.cell!.violating());
  await expect.poll(() => violating()).toEqual([]);
  await page.getByTestId('jog-stop').uncheck();
  for (const [axis, to] of [['T', '-90'], ['RA', '60']] as const) {
    await page.getByTestId(`field-jog-${axis}`).fill(to);
    await page.getByTestId(`field-jog-${axis}`).press('Enter');
  }
  await page.getByTestId('jog-distances').locator('tr', { hasText: 'wall' }).filter({ hasText: 'contact' }).first().waitFor();
  await until('the blade is highlighted', async () => (await violating()).includes('body:blade-A'));
  await expect.poll(() => violating()).toContain('body:wall');
  await expect.poll(() => violating()).not.toContain('zone:wall');
});
