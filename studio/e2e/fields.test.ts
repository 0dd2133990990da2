// Number fields of all views: commas, expressions, units, angles of directions, and messages about refused texts.

import { readFileSync } from 'node:fs';
import { resolve } from 'node:path';
import type { Browser, Page } from 'playwright-core';
import { afterAll, beforeAll, expect, test } from 'vitest';
import { ROOT, browse, cellFixture, checkState, complaints, drawn, load, serve, unhandled, until, visit, waitForCheck, type Server } from './studio';

let browser: Browser;
let server: Server;
const FOUR_BAR = readFileSync(resolve(ROOT, 'crates/jointplay-format/robots/four-bar.toml'), 'utf8');

beforeAll(async () => {
  [browser, server] = await Promise.all([browse(), serve(0, ['four-bar'])]);
});
afterAll(async () => {
  await browser?.close();
  await server?.stop();
});

/** Enters a text into a field. */
async function enter(page: Page, field: string, text: string): Promise<void> {
  await page.getByTestId(field).fill(text);
  await page.getByTestId(field).press('Enter');
}
const value = (page: Page, field: string) => page.getByTestId(field).inputValue();

async function robot(does: (page: Page) => Promise<void>): Promise<void> {
  const page = await visit(browser);
  await load(page, server.address);
  await page.getByRole('button', { name: 'Robot', exact: true }).first().click();
  await drawn(page);
  await does(page);
  await page.context().close();
}

test('station angles accept commas, expressions and units', async () => {
  const fixture = await cellFixture();
  try {
    const page = await visit(fixture.browser, { viewport: { width: 1440, height: 900 } });
    const heard = complaints(page);
    await load(page, fixture.server.address);
    await waitForCheck(page, 'passed');
    await page.locator('details summary', { hasText: 'LP1' }).first().click();
    for (const [field, text, shown] of [
      ['tilt', '0,4', '0.4'], ['tilt', '1/2', '0.5'], ['tilt', '10 mrad', '0.572958'], ['tilt', '0,25 deg', '0.25'],
      ['heading', '90,5', '90.5'], ['heading', '180/2', '90'], ['toward', '45/2', '22.5'], ['toward', '370', '10'],
    ] as const) {
      await enter(page, `station-LP1-${field}`, text);
      await expect.poll(() => value(page, `station-LP1-${field}`), { message: `${field} ${text}` }).toBe(shown);
      await until('the plan of the change', async () => (await checkState(page)) !== 'outdated');
      expect(await value(page, `station-LP1-${field}`), `${field} ${text}, planned`).toBe(shown);
    }
    await enter(page, 'station-LP1-tilt', '2 mm');
    await page.getByRole('alert').filter({ hasText: 'mm is a unit of lengths' }).waitFor();
    expect(await value(page, 'station-LP1-tilt')).toBe('0.25');
    expect(unhandled(heard).filter((line) => !/status of 422/.test(line))).toEqual([]);
  } finally {
    await fixture.close();
  }
});

test('a value that arrives while another is being typed does not replace it', async () => {
  const fixture = await cellFixture();
  try {
    const page = await visit(fixture.browser, { viewport: { width: 1440, height: 900 } });
    await load(page, fixture.server.address);
    await waitForCheck(page, 'passed');
    await page.locator('details summary', { hasText: 'LP1' }).first().click();
    let send: () => void = () => undefined;
    const typed = new Promise<void>((resolve) => (send = resolve));
    await page.route('**/cell/station', async (route) => {
      await typed;
      await route.continue();
    });
    await enter(page, 'station-LP1-tilt', '0,2');
    await page.getByTestId('station-LP1-tilt').fill('0.7');
    send();
    await page.locator('details summary', { hasText: 'tilt 0.200°' }).waitFor();
    expect(await value(page, 'station-LP1-tilt')).toBe('0.7');
    await page.getByTestId('station-LP1-tilt').press('Escape');
    expect(await value(page, 'station-LP1-tilt')).toBe('0.2');
    await waitForCheck(page, 'passed');
  } finally {
    await fixture.close();
  }
});

test('fast changes of one station are all made', async () => {
  const fixture = await cellFixture();
  try {
    const page = await visit(fixture.browser, { viewport: { width: 1440, height: 900 } });
    await load(page, fixture.server.address);
    await waitForCheck(page, 'passed');
    await page.locator('details summary', { hasText: 'LP1' }).first().click();
    let send: () => void = () => undefined;
    const entered = new Promise<void>((resolve) => (send = resolve));
    await page.route('**/cell/station', async (route) => {
      await entered;
      await route.continue();
    });
    const changes = [['tilt', '0.2'], ['toward', '390'], ['x', '-494.9'], ['y', '494.8'], ['heading', '45.1']] as const;
    const shown = { tilt: '0.2', toward: '30', x: '-494.9', y: '494.8', heading: '45.1' };
    for (const [field, text] of changes) {
      await enter(page, `station-LP1-${field}`, text);
      // The same text again, which is no change.
      if (field === 'toward') await enter(page, `station-LP1-${field}`, text);
    }
    expect(await checkState(page)).toBe('outdated');
    send();
    for (const planned of [false, true]) {
      if (planned) await until('the plan of all changes', async () => (await checkState(page)) !== 'outdated');
      for (const [field, text] of Object.entries(shown)) expect(await value(page, `station-LP1-${field}`), `${field}, ${planned}`).toBe(text);
    }
  } finally {
    await fixture.close();
  }
});

test('parameters and joints of a mechanism accept commas, expressions and units', async () => {
  const page = await visit(browser, { viewport: { width: 1440, height: 900 } });
  await load(page, server.address);
  await page.getByTestId('mechanism-name').filter({ hasText: 'Four-bar linkage' }).waitFor();
  for (const [text, shown] of [['0,2005', '0.2005'], ['2/5 - 0,2', '0.2'], ['8 in', '0.2032'], ['201,5 mm', '0.2015'], ['0.2 * sin(90)', '0.2'], ['0.21', '0.21']] as const) {
    await enter(page, 'parameter-rocker', text);
    await expect.poll(() => value(page, 'parameter-rocker'), { message: text }).toBe(shown);
  }
  await enter(page, 'parameter-rocker', 'long');
  await page.getByRole('alert').filter({ hasText: 'unknown name' }).waitFor();
  for (const [text, shown] of [['1,5', '1.5'], ['2,5 + 0,25', '2.75'], ['0,5 deg', '0.5']] as const) {
    await enter(page, 'value-A', text);
    await expect.poll(() => value(page, 'value-A'), { message: text }).toBe(shown);
  }
  await page.context().close();
});

test('while the text of a mechanism has errors, only the text is sent, and joints cannot be driven', async () => {
  const page = await visit(browser, { viewport: { width: 1440, height: 900 } });
  const heard = complaints(page);
  await load(page, server.address);
  await page.getByTestId('m-finite').waitFor();
  await page.getByRole('tab', { name: /^Text/ }).click();
  await page.locator('.cm-content').click();
  await page.keyboard.press('Control+a');
  await page.keyboard.insertText(FOUR_BAR.replace('[parameters]', 'unknown = 1\n[parameters]'));
  await page.getByTestId('mechanism-outdated').waitFor();
  await page.locator('.diagnostics').waitFor();
  await expect.poll(() => page.getByTestId('value-A').isDisabled()).toBe(true);
  await expect.poll(() => page.getByTestId('slide-A').isDisabled()).toBe(true);
  // Longer than the pause after which the mobility is computed.
  await new Promise((wait) => setTimeout(wait, 600));
  await page.locator('.cm-content').click();
  await page.keyboard.press('Control+a');
  await page.keyboard.insertText(FOUR_BAR);
  await page.getByTestId('m-finite').waitFor();
  await enter(page, 'value-A', '10');
  await expect.poll(() => value(page, 'value-A')).toBe('10');
  expect(unhandled(heard)).toEqual([]);
  await page.context().close();
});

test('angles of directions are reduced by whole turns, and a comma may come before a unit', () =>
  robot(async (page) => {
    await enter(page, 'field-tilt', '0,5 deg');
    await drawn(page, 'Math.abs(pose.tilt.angle_rad - Math.PI / 360) < 1e-12');
    await enter(page, 'field-azimuth', '370');
    await drawn(page, 'Math.abs(pose.tilt.azimuth_rad - Math.PI / 18) < 1e-9');
    expect(await value(page, 'field-azimuth')).toBe('10');
    expect(await page.getByRole('alert').count()).toBe(0);
    await enter(page, 'field-azimuth', '-190');
    await expect.poll(() => value(page, 'field-azimuth')).toBe('170');
  }));

test('the message about a refused text ends with the next change of any field', () =>
  robot(async (page) => {
    await enter(page, 'field-tilt', '1,5');
    await drawn(page, 'Math.abs(pose.tilt.angle_rad - Math.PI / 120) < 1e-9');
    const refused = page.getByRole('alert').filter({ hasText: '1.000,5' });
    for (const [field, text] of [['field-height', '480'], ['field-azimuth', '30']] as const) {
      await enter(page, 'field-tilt', '1.000,5');
      await refused.waitFor();
      expect(await value(page, 'field-tilt')).toBe('1.5');
      await enter(page, field, text);
      await until('the message has ended', async () => (await refused.count()) === 0);
    }
    await enter(page, 'field-tilt', '1.000,5');
    await refused.waitFor();
    await page.getByTestId('field-height').press('ArrowUp');
    await until('the message has ended', async () => (await refused.count()) === 0);
  }));

test('a program with invalid commands opens by its extension', async () => {
  const fixture = await cellFixture();
  try {
    const page = await visit(fixture.browser, { viewport: { width: 1440, height: 900 } });
    await load(page, fixture.server.address);
    await waitForCheck(page, 'passed');
    for (const text of ['HOME\nFOO\n', 'TRANSFR LP1 SLOT 1 ALIGN\n']) {
      await page.getByTestId('open').click();
      await page.getByTestId('open-file').setInputFiles({ name: 'b.program', mimeType: 'text/plain', buffer: Buffer.from(text) });
      await page.locator('.cm-content').filter({ hasText: text.trim().split('\n').at(-1)! }).waitFor();
      await page.getByTestId('diagnostics').filter({ hasText: /FOO|TRANSFR/ }).waitFor();
      await page.locator('.cm-lintRange-error').first().waitFor();
    }
  } finally {
    await fixture.close();
  }
});
