// The view of mechanisms: open, drive, analyse, relieve, edit, save.

import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import type { Browser, Page } from 'playwright-core';
import { afterAll, beforeAll, expect, test } from 'vitest';
import { COMMAND, EXAMPLE_CELL, ROOT, SHORT_PROGRAM, accessibilityViolations, browse, bytesOf, complaints, frames, joints, load, reload, serve, unhandled, until, visit, type Server } from './studio';

let browser: Browser;
let folder: string;
const FOUR_BAR = readFileSync(resolve(ROOT, 'crates/jointplay-format/robots/four-bar.toml'), 'utf8');

beforeAll(async () => {
  browser = await browse();
  folder = mkdtempSync(join(tmpdir(), 'studio-'));
});
afterAll(async () => {
  await browser?.close();
  rmSync(folder, { recursive: true });
});

async function at(words: string[], does: (page: Page, server: Server, heard: string[]) => Promise<void>): Promise<void> {
  const server = await serve(0, words);
  const page = await visit(browser, { viewport: { width: 1440, height: 900 } });
  const heard = complaints(page);
  try {
    await load(page, server.address);
    await does(page, server, heard);
  } finally {
    await page.context().close();
    await server.stop();
  }
}

const text = (page: Page, id: string) => page.getByTestId(id).textContent();
const shows = (page: Page, id: string, expected: string | RegExp) => page.getByTestId(id).filter({ hasText: expected }).first().waitFor();
async function openEntry(page: Page, name: string, title: string): Promise<void> {
  await page.getByRole('tab', { name: 'Catalogue' }).click();
  await page.getByTestId(`entry-${name}`).click();
  await shows(page, 'mechanism-name', title);
}
/** Replaces the text in the editor. */
async function type(page: Page, change: (text: string) => string): Promise<void> {
  await page.getByRole('tab', { name: /^Text/ }).click();
  const editor = page.locator('.cm-content');
  await editor.waitFor();
  await editor.click();
  await page.keyboard.press('Control+a');
  await page.keyboard.insertText(change(''));
}

test('a mechanism of the command is opened, driven and analysed', async () => {
  await at(['four-bar'], async (page, _, heard) => {
    await shows(page, 'mechanism-name', 'Four-bar linkage');
    await until('the mobility', async () => (await page.getByTestId('m-finite').count()) === 1);
    await expect.poll(async () => [await text(page, 'm-kutzbach'), await text(page, 'm-instantaneous'), await text(page, 'm-finite'), await text(page, 'm-redundant')]).toEqual(['−2', '1', '1', '3']);
    // The exported motion has the bytes of the command.
    const out = join(folder, 'motion');
    execFileSync(COMMAND, ['move', 'four-bar', '--drive', 'A=-5:20', '--steps', '4', '--to', 'csv,gltf', '--out', out]);
    for (const format of ['csv', 'gltf']) {
      await page.getByTestId('mechanism-export').click();
      await page.getByTestId('motion-from').fill('-5');
      await page.getByTestId('motion-to').fill('40/2');
      await page.getByTestId('motion-steps').fill('4');
      await page.getByTestId('motion-steps').press('Tab');
      const awaited = page.waitForEvent('download');
      await page.getByTestId(`mechanism-export-${format}`).click();
      const download = await awaited;
      const name = `four-bar-motion.${format === 'csv' ? 'csv' : 'glb'}`;
      expect(download.suggestedFilename()).toBe(name);
      expect((await bytesOf(download)).equals(readFileSync(join(out, name))), name).toBe(true);
    }
    await page.getByTestId('take-reference').click();
    // The crank turns about A: its end B is where trigonometry places it.
    const before = await joints(page);
    const crank = Math.hypot(...[0, 1, 2].map((k) => before['B']![k]! - before['A']![k]!));
    const field = page.getByTestId('value-A');
    await field.fill('180/2');
    await field.press('Enter');
    // The coordinate is zero in the reference configuration, with the crank at 70°.
    const [x, y] = [Math.cos((160 * Math.PI) / 180) * crank, Math.sin((160 * Math.PI) / 180) * crank];
    await until('the crank at 160°', async () => Math.hypot((await joints(page))['B']![0]! - x, (await joints(page))['B']![1]! - y) < 1e-9);
    await expect.poll(() => field.inputValue()).toBe('90');
    // Keyboard: the slider moves by the arrow keys.
    await page.getByTestId('slide-A').press('ArrowRight');
    await until('the crank moved on', async () => (await field.inputValue()) !== '90');
    // A value that is no expression is refused next to its field, and nothing moves.
    const kept = await joints(page);
    await field.fill('4 mm');
    await field.press('Enter');
    await page.getByRole('alert').filter({ hasText: 'mm' }).waitFor();
    await expect.poll(() => joints(page)).toEqual(kept);
    // Compared with the reference: the crank has turned, the mobility is the same.
    const compared = async (name: string) => (await page.getByTestId(`compare-${name}`).locator('td').allTextContents()).map(Number);
    await until('compared', async () => [...(await compared('finite')), ...(await compared('redundant')), ...(await compared('A'))].every(Number.isFinite));
    const [from, now, by] = await compared('A');
    expect([from, by]).toEqual([0, now]);
    await expect.poll(() => compared('redundant')).toEqual([3, 3, 0]);
    // Dragged by its end, the crank follows the pointer, and the other joints follow the crank.
    await page.getByRole('button', { name: 'Fit', exact: true }).click();
    await frames(page);
    const { x: fromX, y: fromY } = (await page.evaluate(() => window.jointplay.probe.mechanism!.onPage('B')))!;
    await page.mouse.move(fromX, fromY);
    await page.mouse.down();
    for (const share of [0.3, 0.6, 1]) await page.mouse.move(fromX - 20 * share, fromY + 90 * share);
    const apart = (a: Record<string, number[]>, name: string) => Math.hypot(...a[name]!.map((value, k) => value - kept[name]![k]!));
    await until('dragged', async () => apart(await joints(page), 'B') > 0.01 && apart(await joints(page), 'C') > 0.01);
    await page.mouse.up();
    await until('it rests', async () => (await page.getByText('Moving…').count()) === 0);
    const dragged = await joints(page);
    expect(Math.hypot(...dragged['B']!.map((value, k) => value - dragged['A']![k]!))).toBeCloseTo(crank, 9);
    // By numbers: the nearest point of the circle of B.
    await page.keyboard.press('Escape');
    await page.getByRole('tab', { name: 'Tree' }).click();
    await page.getByTestId('tree-joint-B').click();
    await shows(page, 'point-position', 'Position');
    await page.getByTestId('point-x').fill('0.5 m');
    await page.getByTestId('point-x').press('Enter');
    await page.getByTestId('point-y').fill('500');
    await page.getByTestId('point-y').press('Enter');
    await shows(page, 'point-message', 'nearest reachable position');
    await until('moved to the nearest point', async () => {
      const { A, B } = await joints(page);
      const [u, v] = [0.5 - A![0]!, 0.5 - A![1]!];
      return Math.hypot(B![0]! - A![0]! - (crank * u) / Math.hypot(u, v), B![1]! - A![1]! - (crank * v) / Math.hypot(u, v)) < 1e-6;
    });
    expect(unhandled(heard).filter((line) => !/status of 422/.test(line))).toEqual([]);
  });
});

test('a dead point stops the drive, and is reported with its place', async () => {
  await at(['four-bar'], async (page) => {
    await shows(page, 'mechanism-name', 'Four-bar linkage');
    // Driven from the rocker, the crank and coupler come in line.
    await type(page, () => FOUR_BAR.replace('actuated = true\n', '').replace('name = "D"\n', 'name = "D"\nactuated = true\n'));
    const field = page.getByTestId('value-D');
    await field.waitFor();
    await field.fill('170');
    await field.press('Enter');
    await shows(page, 'stopped', 'dead point');
    await expect.poll(async () => Number(await field.inputValue())).toBeLessThan(170);
  });
});

test('the robot of the paper is relieved by a suggestion, and its play is exaggerated', async () => {
  await at([], async (page, _, heard) => {
    await page.getByRole('button', { name: 'Mechanism' }).click();
    await openEntry(page, 'gpr-mechanism', 'as a mechanism');
    await until('the mobility', async () => (await page.getByTestId('m-finite').count()) === 1);
    // Redundant constraints highlight their joints.
    await page.getByTestId('redundant').getByRole('button').first().click();
    await page.getByText('Highlighted: rod 1, rod 2, S1, S2').waitFor();
    // Of three instantaneous motions, one is finite.
    await page.getByTestId('animate-motions').click();
    await shows(page, 'animated', 'Instantaneous motion 1 of 3');
    await page.keyboard.press('Escape');
    await expect.poll(() => page.getByTestId('animated').count()).toBe(0);
    await page.getByTestId('suggest').click();
    await page.getByTestId('apply-0').click();
    // A joint that is driven while the text is still being read moves afterwards.
    const drive = page.getByTestId('value-rod 1');
    await drive.fill('2');
    await drive.press('Enter');
    await until('displaced', async () => !(await page.getByText('All virtual joints are at rest.').isVisible()));
    const links = () => page.evaluate(() => window.jointplay.probe.mechanism?.links() ?? {});
    const truth = await links();
    await page.getByTestId('play-scale').press('End');
    await until('exaggerated', async () => JSON.stringify(await links()) !== JSON.stringify(truth));
    await page.getByTestId('play-scale').press('Home');
    await until('true again', async () => JSON.stringify(await links()) === JSON.stringify(truth));
    // Undo returns to the text without the suggestion.
    await page.getByRole('button', { name: 'Undo' }).click();
    await until('undone', async () => page.getByTestId('redundant').isVisible());
    expect(unhandled(heard)).toEqual([]);
  });
});

test('files of all kinds are opened, or their kind is reported', async () => {
  const cell = join(folder, 'cell.toml');
  writeFileSync(cell, EXAMPLE_CELL);
  await at(['--cell', cell], async (page) => {
    await page.getByRole('button', { name: 'Mechanism' }).click();
    const input = page.getByTestId('mechanism-file');
    const file = (name: string, content: string) => ({ name, mimeType: 'text/plain', buffer: Buffer.from(content) });
    await input.setInputFiles(file('study.toml', 'kind = "study"\n'));
    await shows(page, 'mechanism-notice', 'This is a study');
    await input.setInputFiles(file('big.urdf', `<robot name="a">${' '.repeat(10_000_000)}</robot>`));
    await shows(page, 'mechanism-notice', '10.00 MB');
    // Short as a file, and too long in a request.
    await input.setInputFiles(file('lines.urdf', `<robot name="a">${'\n'.repeat(6_000_000)}</robot>`));
    await shows(page, 'mechanism-notice', 'needs 12.00 MB in a request');
    await input.setInputFiles(file('broken.toml', FOUR_BAR.slice(0, FOUR_BAR.length / 2)));
    await page.getByTestId('mechanism-diagnostics').waitFor();
    const urdf = '<robot name="arm"><link name="base"/><link name="a"/><link name="b"/><joint name="A" type="continuous"><parent link="base"/><child link="a"/><axis xyz="0 0 1"/></joint><joint name="B" type="prismatic"><parent link="a"/><child link="b"/><origin xyz="0.2 0 0"/><axis xyz="0 0 1"/><limit lower="0" upper="0.1" effort="1" velocity="1"/></joint></robot>';
    const loops = 'kind = "loops"\nunits = { length = "m", angle = "rad" }\n[[joint]]\nname = "C"\nkind = "cylindrical"\nlinks = ["base", "b"]\npoint = [0.2, 0, 0]\naxis = [0, 0, 1]\n';
    await input.setInputFiles([file('arm.urdf', urdf), file('arm-loops.toml', loops)]);
    await shows(page, 'mechanism-notice', 'Converted from URDF');
    // The note covers nothing of the view.
    const note = (await page.getByTestId('mechanism-notice').boundingBox())!;
    for (const part of ['.scene', '[data-testid=cube]', '.views']) await expect.poll(async () => (await page.locator(part).first().boundingBox())!.y, { message: part }).toBeGreaterThanOrEqual(note.y + note.height);
    await page.getByTestId('tree-joint-C').click();
    await shows(page, 'properties', 'cylindrical');
    // Dropped files.
    const dropped = await page.evaluateHandle((content) => {
      const data = new DataTransfer();
      data.items.add(new File([content], 'mine.toml'));
      return data;
    }, FOUR_BAR);
    await page.dispatchEvent('.mechanism', 'drop', { dataTransfer: dropped });
    await shows(page, 'mechanism-name', 'Four-bar linkage');
    // Cells and programs open in their own view.
    await input.setInputFiles(file('other.toml', EXAMPLE_CELL.replace(/name = "[^"]*"/, 'name = "dropped cell"')));
    await page.getByRole('region', { name: 'Work cell' }).waitFor();
    await page.getByRole('tab', { name: 'Cell file' }).click();
    await page.locator('.cm-content').filter({ hasText: 'dropped cell' }).waitFor();
    // It is not the file of the server.
    await shows(page, 'cell-file', 'other.toml, not on the server');
    expect(readFileSync(cell, 'utf8')).toBe(EXAMPLE_CELL);
    await page.getByRole('button', { name: 'Mechanism', exact: true }).click();
    const program = await page.evaluateHandle((content) => {
      const data = new DataTransfer();
      data.items.add(new File([content], 'dropped.program'));
      return data;
    }, SHORT_PROGRAM);
    await page.dispatchEvent('.mechanism', 'drop', { dataTransfer: program });
    await page.getByRole('region', { name: 'Work cell' }).waitFor();
    await page.locator('.cm-content').filter({ hasText: 'GET LP1 SLOT 1 WITH A' }).waitFor();
    // A three-rod robot is shown as a mechanism, and in its own view.
    await page.getByRole('button', { name: 'Mechanism', exact: true }).click();
    await input.setInputFiles(file('robot.toml', readFileSync(resolve(ROOT, 'crates/jointplay-format/robots/gpr.toml'), 'utf8').replace(/^name = "[^"]*"/m, 'name = "My robot"')));
    await page.getByRole('button', { name: 'Open it in the robot view' }).click();
    await page.getByTestId('robot-fields').waitFor();
    await page.getByTestId('slider-tilt').waitFor();
  });
});

test('a text with errors keeps no result, and a file is saved unless it changed on disk', async () => {
  const file = join(folder, 'linkage.toml');
  writeFileSync(file, FOUR_BAR);
  await at([file], async (page, server) => {
    await shows(page, 'mechanism-name', 'Four-bar linkage');
    await until('the mobility', async () => (await page.getByTestId('m-finite').count()) === 1);
    await type(page, () => FOUR_BAR.replace('kind = "revolute"', 'kind = "revolut"'));
    await page.getByTestId('mechanism-diagnostics').waitFor();
    await page.getByTestId('mechanism-outdated').waitFor();
    await expect.poll(() => page.getByTestId('m-finite').count()).toBe(0);
    await type(page, () => FOUR_BAR.replace('Planar four-bar linkage', 'Renamed linkage'));
    await shows(page, 'mechanism-name', 'Renamed');
    // A file that cannot be written is reported until it is saved.
    await page.route('**/api/v1/mechanism', (route) => route.fulfill({ status: 409, contentType: 'application/problem+json', body: '{"detail":"the disk is full"}' }), { times: 1 });
    await page.keyboard.press('Control+s');
    await page.getByTestId('mechanism-notice').waitFor();
    await page.keyboard.press('Control+s');
    await until('saved', async () => readFileSync(file, 'utf8').includes('Renamed linkage'));
    await page.getByTestId('mechanism-notice').waitFor({ state: 'hidden' });
    writeFileSync(file, `${FOUR_BAR}# another editor\n`);
    await type(page, () => FOUR_BAR.replace('Planar four-bar linkage', 'Third linkage'));
    await page.keyboard.press('Control+s');
    await page.getByTestId('mechanism-conflict').waitFor();
    expect(readFileSync(file, 'utf8')).toContain('another editor');
    await page.getByTestId('mechanism-conflict-show').click();
    const lines = (kind: string) => page.getByTestId('mechanism-conflict-difference').locator(`.${kind} code`).allTextContents();
    await until('the difference', async () => (await lines('added')).length > 0);
    await expect.poll(() => lines('removed')).toContain('# another editor');
    await expect.poll(async () => (await lines('added')).join('\n')).toContain('Third linkage');
    await page.getByRole('button', { name: 'Overwrite' }).click();
    await until('overwritten', async () => readFileSync(file, 'utf8').includes('Third linkage'));
    // Without a server, no number remains.
    await until('the mobility', async () => (await page.getByTestId('m-finite').count()) === 1);
    await server.stop();
    await page.getByTestId('mechanism-outdated').waitFor();
    await expect.poll(() => page.getByTestId('m-finite').count()).toBe(0);
  });
});

test('an unsaved text survives a reload, and is restored or discarded', async () => {
  const file = join(folder, 'draft.toml');
  writeFileSync(file, FOUR_BAR);
  await at([file], async (page) => {
    page.on('dialog', (dialog) => void dialog.accept());
    const draft = page.getByTestId('mechanism-draft');
    await shows(page, 'mechanism-name', 'Planar four-bar linkage');
    await expect.poll(() => draft.count()).toBe(0);
    await type(page, () => FOUR_BAR.replace(/^name = "[^"]*"/m, 'name = "Unsaved linkage"'));
    await shows(page, 'mechanism-name', 'Unsaved linkage');
    await reload(page);
    await draft.filter({ hasText: 'unsaved changes to draft.toml' }).waitFor();
    await shows(page, 'mechanism-name', 'Planar four-bar linkage');
    // Another visit keeps the offer.
    await reload(page);
    await draft.getByRole('button', { name: 'Restore' }).click();
    await shows(page, 'mechanism-name', 'Unsaved linkage');
    expect(readFileSync(file, 'utf8')).toBe(FOUR_BAR);
    await page.keyboard.press('Control+s');
    await until('saved', async () => readFileSync(file, 'utf8').includes('Unsaved linkage'));
    await reload(page);
    await shows(page, 'mechanism-name', 'Unsaved linkage');
    await expect.poll(() => draft.count(), { message: 'a saved text is no draft' }).toBe(0);
    await type(page, () => FOUR_BAR.replace(/^name = "[^"]*"/m, 'name = "Other"'));
    await shows(page, 'mechanism-name', 'Other');
    // Changes of another text are not saved into the file.
    const theirs = `${readFileSync(file, 'utf8')}# theirs\n`;
    writeFileSync(file, theirs);
    await reload(page);
    await draft.getByRole('button', { name: 'Restore' }).click();
    await shows(page, 'mechanism-name', 'Other');
    await expect.poll(() => page.getByTestId('mechanism-save').count()).toBe(0);
    await page.getByRole('button', { name: 'Undo' }).click();
    await shows(page, 'mechanism-name', 'Unsaved linkage');
    await expect.poll(() => page.getByTestId('mechanism-save').count()).toBe(1);
    expect(readFileSync(file, 'utf8')).toBe(theirs);
    await page.getByRole('button', { name: 'Redo' }).click();
    await shows(page, 'mechanism-name', 'Other');
    await reload(page);
    await draft.getByRole('button', { name: 'Discard' }).click();
    await reload(page);
    await shows(page, 'mechanism-name', 'Unsaved linkage');
    await expect.poll(() => draft.count()).toBe(0);
  });
});

test('after a failed reload, a file that changed on disk is still not overwritten without a question', async () => {
  const file = join(folder, 'reloaded.toml');
  writeFileSync(file, FOUR_BAR);
  await at([file], async (page) => {
    await shows(page, 'mechanism-name', 'Four-bar linkage');
    await type(page, () => FOUR_BAR.replace('Planar four-bar linkage', 'My linkage'));
    await shows(page, 'mechanism-name', 'My linkage');
    const theirs = `${FOUR_BAR}# another editor\n`;
    writeFileSync(file, theirs);
    await page.getByTestId('mechanism-save').click();
    await page.getByTestId('mechanism-conflict').waitFor();
    // The server cannot read the text at this time.
    await page.route('**/api/v1/mechanism/open', (route) => route.fulfill({ status: 503, contentType: 'application/problem+json', body: '{"detail": "the server is busy"}' }));
    await page.getByRole('button', { name: 'Reload from disk' }).click();
    await shows(page, 'mechanism-notice', 'the server is busy');
    await page.unroute('**/api/v1/mechanism/open');
    await page.getByTestId('mechanism-save').click();
    await page.getByTestId('mechanism-conflict').waitFor();
    expect(readFileSync(file, 'utf8')).toBe(theirs);
    // After a reload that succeeds, changes are saved.
    await page.getByRole('button', { name: 'Reload from disk' }).click();
    await shows(page, 'mechanism-name', 'Four-bar linkage');
    await type(page, () => `${theirs}# mine\n`);
    await page.keyboard.press('Control+s');
    await until('saved', async () => readFileSync(file, 'utf8') === `${theirs}# mine\n`);
  });
});

test('a text is not saved into the file of another server', async () => {
  const [mine, theirs] = ['mine.toml', 'theirs.toml'].map((name) => join(folder, name)) as [string, string];
  const other = FOUR_BAR.replace('Planar four-bar linkage', 'Linkage of another server');
  writeFileSync(mine, FOUR_BAR);
  writeFileSync(theirs, other);
  await at([mine], async (page, server) => {
    await shows(page, 'mechanism-name', 'four-bar linkage');
    await type(page, () => `${FOUR_BAR}# a change\n`);
    await server.stop();
    const second = await serve(server.port, [theirs]);
    try {
      await until('it is connected again', async () => !(await page.locator('header').innerText()).includes('Disconnected'));
      await page.getByTestId('mechanism-save').click();
      await shows(page, 'mechanism-notice', 'Not saved: the server has the file theirs.toml now, and not mine.toml.');
      await expect.poll(() => page.getByTestId('mechanism-conflict').count()).toBe(0);
      expect([readFileSync(mine, 'utf8'), readFileSync(theirs, 'utf8')]).toEqual([FOUR_BAR, other]);
    } finally {
      await second.stop();
    }
  });
});

test('a file that is not a text is refused, and the mechanism stays', async () => {
  await at(['four-bar'], async (page) => {
    await shows(page, 'mechanism-name', 'four-bar linkage');
    await page.getByTestId('mechanism-file').setInputFiles({ name: 'picture.toml', mimeType: 'image/png', buffer: Buffer.from([0x89, 0x50, 0x4e, 0x47, 13, 10, 26, 10, 0, 0, 0, 13]) });
    await shows(page, 'mechanism-notice', 'picture.toml is not a text file in UTF-8.');
    await shows(page, 'mechanism-name', 'four-bar linkage');
  });
});

test('parameters and assembly modes change the configuration', async () => {
  await at(['four-bar'], async (page) => {
    await shows(page, 'mechanism-name', 'Four-bar linkage');
    const before = await joints(page);
    await page.getByTestId('find-modes').click();
    const modes = page.getByTestId('modes').getByRole('button');
    await until('two modes', async () => (await modes.count()) === 2);
    await modes.nth(1).click();
    await until('the other mode', async () => Math.abs((await joints(page))['C']![1]! - before['C']![1]!) > 1e-3);
    await expect.poll(async () => (await joints(page))['B']![0]).toBeCloseTo(before['B']![0]!, 9);
    const length = async () => {
      const { B, C } = await joints(page);
      return Math.hypot(...[0, 1, 2].map((k) => B![k]! - C![k]!));
    };
    const field = page.getByTestId('parameter-rocker');
    const coupler = await length();
    await field.fill(String(Number(await field.inputValue()) * 1.1));
    await field.press('Enter');
    await until('a longer rocker', async () => {
      const { C, D } = await joints(page);
      return Math.abs(Math.hypot(...[0, 1, 2].map((k) => C![k]! - D![k]!)) - 0.22) < 1e-9;
    });
    await expect.poll(() => length()).toBeCloseTo(coupler, 9);
  });
});

test.each([
  ['light', 1440, 900],
  ['dark', 1440, 900],
  ['light', 1024, 700],
  ['dark', 390, 844],
] as const)('accessible and complete: %s, %i × %i', async (colorScheme, width, height) => {
  const server = await serve(0, ['gpr-mechanism']);
  const page = await visit(browser, { viewport: { width, height }, colorScheme });
  try {
    await load(page, server.address);
    await shows(page, 'mechanism-name', 'as a mechanism');
    await until('the mobility', async () => (await page.getByTestId('m-finite').count()) === 1);
    for (const tab of ['Catalogue', 'Tree', 'Text']) {
      await page.getByRole('tab', { name: tab }).click();
      await frames(page);
      await expect.poll(() => accessibilityViolations(page), { message: tab }).toEqual([]);
    }
    // Chosen entries of lists are legible.
    await page.getByTestId('redundant').getByRole('button').first().click();
    await page.getByRole('tab', { name: 'Tree' }).click();
    await page.getByTestId('tree-link-platform').click();
    await page.getByTestId('find-modes').click();
    await page.getByTestId('modes').waitFor();
    await expect.poll(() => page.locator('button.plain[aria-pressed=true]').count()).toBeGreaterThanOrEqual(2);
    await expect.poll(() => accessibilityViolations(page)).toEqual([]);
    // Nothing is wider than the window, and the view has a size.
    await expect.poll(() => page.evaluate(() => document.documentElement.scrollWidth)).toBeLessThanOrEqual(width);
    const view = await page.locator('.mechanism .scene').boundingBox();
    expect(view!.width).toBeGreaterThan(300);
    expect(view!.height).toBeGreaterThan(250);
  } finally {
    await page.context().close();
    await server.stop();
  }
});
