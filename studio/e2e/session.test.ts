// Editing sessions: unsaved changes are preserved, and a result is shown as valid only for the checked state.

import { readFileSync, writeFileSync } from 'node:fs';
import type { Page } from 'playwright-core';
import { afterAll, afterEach, beforeAll, beforeEach, expect, test } from 'vitest';
import { EXAMPLE_CELL, SHORT_PROGRAM, bytesOf, cellFixture, checkState, complaints, frames, load, partNames, reload, serve, unhandled, until, visit, waitForCheck, type CellFixture } from './studio';

let fixture: CellFixture;
let page: Page;
let heard: string[];

beforeAll(async () => {
  fixture = await cellFixture();
});
afterAll(() => fixture?.close());
// Each test has a browser context of its own, and the original files.
beforeEach(async () => {
  writeFileSync(fixture.cellFile, EXAMPLE_CELL);
  writeFileSync(fixture.programFile, SHORT_PROGRAM);
  page = await visit(fixture.browser);
  heard = complaints(page);
  await load(page, fixture.server.address);
  await checkResult('passed');
});
afterEach(async () => {
  // The browser itself notes requests without an answer, and those about a plan that was replaced or that a new server does not know.
  expect(unhandled(heard).filter((line) => !line.includes('ERR_CONNECTION_REFUSED'))).toEqual([]);
  await page.context().close();
});

const shown = () => checkState(page);
const checkResult = (state: string) => waitForCheck(page, state);
const editor = () => page.getByTestId('text-program').locator('.cm-content');
const text = () => editor().innerText();

async function append(words: string): Promise<void> {
  await editor().click();
  await page.keyboard.press('Control+End');
  await page.keyboard.insertText(words);
}

/** Blocks requests, by default of plans, until the returned function is called. */
async function hold(requests = '**/api/v1/cell/plan'): Promise<() => Promise<void>> {
  let release = () => undefined as void;
  const released = new Promise<void>((done) => (release = done));
  await page.route(requests, async (route) => {
    await released;
    await route.continue().catch(() => undefined);
  });
  return async () => {
    release();
    await page.unroute(requests);
  };
}

/** The result is shown as outdated wherever it is shown. */
async function outdated(): Promise<void> {
  await checkResult('outdated');
  await expect.poll(() => page.getByTestId('check-result').innerText()).toContain('Outdated');
  await expect.poll(() => page.getByText('No violations of reach').count()).toBe(0);
  await expect.poll(() => page.getByTestId('gantt').getAttribute('data-outdated')).toBe('true');
  await expect.poll(() => page.getByTestId('outdated').isVisible()).toBe(true);
  await expect.poll(() => page.title()).toMatch(/^Outdated/);
}
/** And valid again. */
async function valid(): Promise<void> {
  await checkResult('passed');
  await expect.poll(() => page.getByTestId('gantt').getAttribute('data-outdated')).toBe('false');
  await expect.poll(() => page.getByTestId('outdated').count()).toBe(0);
  await expect.poll(() => page.title()).toMatch(/^No violations/);
}

test('typing makes the result outdated until the text is checked', async () => {
  await valid();
  const release = await hold();
  await append('#');
  await outdated();
  await release();
  await valid();
  const again = await hold();
  await page.getByRole('button', { name: 'Undo' }).click();
  await outdated();
  await again();
  await valid();
});

test('before the first plan, panels wait for it and report no errors', async () => {
  const release = await hold();
  await page.reload();
  await page.getByText('Waiting for the plan…').waitFor();
  await expect.poll(() => page.getByText('Waiting for the pose…').count()).toBe(2);
  expect(await page.getByText('fix the errors').count()).toBe(0);
  await release();
  await valid();
});

test('typing a number makes the result outdated until its change is checked', async () => {
  await page.locator('summary', { hasText: 'LP2' }).click();
  await page.getByTestId('station-LP2-x').fill('-200');
  await outdated();
  let release = () => undefined as void;
  const released = new Promise<void>((done) => (release = done));
  await page.route('**/api/v1/cell/station', async (route) => {
    await released;
    await route.continue();
  });
  await page.getByTestId('station-LP2-x').press('Enter');
  await frames(page);
  await outdated();
  const held = await hold();
  release();
  await until('the number is in the text', async () => (await page.getByTestId('save').isEnabled()));
  await outdated();
  await held();
  await checkResult('failed');
  await expect.poll(() => page.title()).toMatch(/^\d+ violations \(unsaved\)/);
  // Parts in collision lose their colour with the result.
  const colour = () => page.evaluate(() => window.jointplay.probe.cell!.violationColor());
  const red = await colour();
  const last = await hold();
  await page.getByRole('button', { name: 'Undo' }).click();
  await outdated();
  await expect.poll(() => colour()).not.toBe(red);
  await last();
  await valid();
  await expect.poll(() => colour()).toBe(red);
});

test('dragging a station makes the result outdated', async () => {
  await page.getByRole('tab', { name: 'Parts' }).click();
  await page.getByTestId('parts').getByRole('button', { name: /^ALIGN/ }).click();
  const grip = () => page.evaluate(() => window.jointplay.probe.cell!.grip('height' as never));
  await until('there is a handle', async () => (await grip()) !== null);
  // Its size and the picture are settled before it is dragged.
  await until('all is drawn', async () => (await page.getByTestId('planned').innerText()).startsWith('Planned'));
  let from = { x: NaN, y: NaN };
  await until('it rests', async () => {
    const before = from;
    await frames(page);
    from = (await grip())!;
    return Math.hypot(from.x - before.x, from.y - before.y) < 0.5;
  });
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  await page.mouse.move(from.x, from.y - 6);
  await page.mouse.move(from.x, from.y - 12);
  await outdated();
  const release = await hold();
  await page.mouse.up();
  await outdated();
  await release();
  // Checked, whatever the result.
  await until('it is checked', async () => ['passed', 'failed'].includes((await shown())!));
  await expect.poll(() => page.getByTestId('gantt').getAttribute('data-outdated')).toBe('false');
});

test('without a server the result is outdated and saving fails; the page recovers by itself', async () => {
  // The editor is a part of the page that is loaded when the text is first shown.
  await editor().waitFor();
  await fixture.server.stop();
  // Without any input, the page notices by itself.
  await outdated();
  await page.getByTestId('disconnected').waitFor();
  await append('# while away\n');
  await page.getByTestId('save').click();
  await page.getByRole('alert').filter({ hasText: 'Not saved: the server does not respond' }).waitFor();
  await outdated();
  expect(readFileSync(fixture.programFile, 'utf8')).toBe(SHORT_PROGRAM);
  fixture.server = await serve(fixture.server.port, ['--cell', fixture.cellFile]);
  await checkResult('passed');
  await page.getByTestId('disconnected').waitFor({ state: 'hidden' });
  await page.getByTestId('save').click();
  await until('it is saved', async () => readFileSync(fixture.programFile, 'utf8') === `${SHORT_PROGRAM}# while away\n`);
  await until('the note is closed', async () => (await page.getByRole('alert').count()) === 0);
});

test('edits, undo history and the open text persist in the robot view', async () => {
  await append('# one\n');
  await until('it can be undone', () => page.getByRole('button', { name: 'Undo' }).isEnabled());
  await checkResult('passed');
  await page.getByRole('button', { name: 'Robot', exact: true }).click();
  await until('the robot is drawn', () => page.evaluate(() => window.jointplay.probe.frames > 0));
  await expect.poll(() => page.title()).toBe('jointplay studio');
  let fetched = 0;
  page.on('request', (request) => void (fetched += Number(/\/cell(\/plan|\/motion.glb)?$/.test(request.url()))));
  await page.getByRole('button', { name: 'Cell', exact: true }).click();
  await editor().waitFor();
  await expect.poll(() => text()).toContain('# one');
  await expect.poll(() => shown()).toBe('passed');
  await expect.poll(() => page.getByTestId('save').isEnabled()).toBe(true);
  await until('it is drawn', async () => (await partNames(page)).length > 0);
  expect(fetched, 'what is there is not fetched again').toBe(0);
  // The editor is a new one, and undoes what was typed into the old one all the same.
  await editor().click();
  await page.keyboard.press('Control+z');
  await until('it is undone', async () => !(await text()).includes('# one'));
  await checkResult('passed');
  await expect.poll(() => page.getByTestId('save').isDisabled()).toBe(true);
});

test('closing with unsaved changes requires a confirmation, and reloading restores them', async () => {
  const asked: string[] = [];
  page.on('dialog', (dialog) => {
    asked.push(dialog.type());
    void dialog.accept();
  });
  await reload(page);
  await checkResult('passed');
  expect(asked, 'nothing unsaved, nothing asked').toEqual([]);
  await append('# draft\n');
  // At once: the text has not rested yet.
  await reload(page);
  expect(asked).toEqual(['beforeunload']);
  await page.getByTestId('draft').filter({ hasText: 'were restored' }).waitFor();
  await expect.poll(() => text()).toContain('# draft');
  await checkResult('passed');
  await expect.poll(() => page.title()).toContain('(unsaved)');
  await page.getByRole('button', { name: 'Discard' }).click();
  await until('the text is the file’s', async () => !(await text()).includes('# draft'));
  await expect.poll(() => page.getByTestId('draft').count()).toBe(0);
  await page.getByRole('button', { name: 'Undo' }).click();
  await until('it can be had back', async () => (await text()).includes('# draft'));
  await page.getByTestId('save').click();
  await until('it is saved', () => page.getByTestId('save').isDisabled());
  asked.length = 0;
  await reload(page);
  await checkResult('passed');
  expect(asked).toEqual([]);
  await expect.poll(() => page.getByTestId('draft').count()).toBe(0);
  await expect.poll(() => text()).toContain('# draft');
});

test('a draft of changed files is offered and not applied', async () => {
  page.on('dialog', (dialog) => void dialog.accept());
  await append('# mine\n');
  await checkResult('passed');
  writeFileSync(fixture.programFile, `${SHORT_PROGRAM}# theirs\n`);
  await reload(page);
  await page.getByTestId('draft').filter({ hasText: 'another version of the files' }).waitFor();
  await expect.poll(() => text()).toContain('# theirs');
  await append('# more\n');
  await checkResult('passed');
  await reload(page);
  await page.getByTestId('draft').filter({ hasText: 'were restored' }).waitFor();
  await expect.poll(() => text()).toContain('# more');
  await page.getByRole('button', { name: 'Discard' }).click();
  await checkResult('passed');
  await expect.poll(() => text()).not.toContain('# mine');
});

test('a draft of another version is restored on request, and undo reverts it', async () => {
  page.on('dialog', (dialog) => void dialog.accept());
  await append('# mine\n');
  await checkResult('passed');
  writeFileSync(fixture.programFile, `${SHORT_PROGRAM}# theirs\n`);
  await reload(page);
  await page.getByTestId('draft').filter({ hasText: 'another version of the files' }).waitFor();
  await page.getByRole('button', { name: 'Restore' }).click();
  await until('mine is there', async () => (await text()).includes('# mine'));
  await expect.poll(() => text()).not.toContain('# theirs');
  await page.getByRole('button', { name: 'Undo' }).click();
  await until('theirs is there', async () => (await text()).includes('# theirs'));
});

test('Ctrl+S saves in the editor and in a number field', async () => {
  await append('# by key\n');
  await page.keyboard.press('Control+s');
  await until('it is saved', async () => readFileSync(fixture.programFile, 'utf8') === `${SHORT_PROGRAM}# by key\n`);
  await page.locator('summary', { hasText: 'LP1' }).click();
  await page.getByTestId('station-LP1-x').fill('-494');
  await page.keyboard.press('Control+s');
  await until('the number is saved', async () => readFileSync(fixture.cellFile, 'utf8').includes('-494'));
});

test('another cell is opened and downloaded, and the files of the server remain', async () => {
  const saves: string[] = [];
  page.on('request', (request) => request.method() === 'PUT' && saves.push(request.url()));
  const file = () => page.getByTestId('cell-file').innerText();
  const other = EXAMPLE_CELL.replace(/^name = "[^"]*"/m, 'name = "other cell"');
  await append('# mine\n');
  await checkResult('passed');
  await page.keyboard.press('Control+o');
  await page.getByTestId('open-file').setInputFiles({ name: 'other.toml', mimeType: 'text/plain', buffer: Buffer.from(other) });
  await expect.poll(file).toBe('other.toml, not on the server');
  await expect.poll(() => page.getByTestId('save').count()).toBe(0);
  await expect.poll(async () => (await text()).trim(), { message: 'the program of the server is not that of the other cell' }).toBe('');
  await editor().click();
  await page.keyboard.insertText(SHORT_PROGRAM);
  await checkResult('passed');
  await expect.poll(file).toBe('other.toml, not on the server: Unsaved changes');
  // Ctrl+S downloads the changed text.
  const [program] = await Promise.all([page.waitForEvent('download'), page.keyboard.press('Control+s')]);
  expect([program.suggestedFilename(), (await bytesOf(program)).toString('utf8')]).toEqual(['other.program', SHORT_PROGRAM]);
  await expect.poll(file).toBe('other.toml, not on the server');
  const [cell] = await Promise.all([page.waitForEvent('download'), page.getByTestId('cell-download').click()]);
  expect([cell.suggestedFilename(), (await bytesOf(cell)).toString('utf8')]).toEqual(['other.toml', other]);
  // Undo returns to the files of the server with their unsaved changes.
  const undo = page.getByRole('button', { name: 'Undo' });
  await undo.click();
  await until('the program is empty again', async () => (await text()).trim() === '');
  await undo.click();
  await expect.poll(file).toBe('mine.toml: Unsaved changes');
  await expect.poll(() => text()).toContain('# mine');
  await page.getByRole('button', { name: 'Redo' }).click();
  await expect.poll(file).toContain('other.toml, not on the server');
  await page.keyboard.press('Control+o');
  await page.getByTestId('open-server-cell').click();
  await expect.poll(file).toBe('mine.toml');
  expect(saves).toEqual([]);
  expect([readFileSync(fixture.cellFile, 'utf8'), readFileSync(fixture.programFile, 'utf8')]).toEqual([EXAMPLE_CELL, SHORT_PROGRAM]);
  await checkResult('passed');
  await append('# saved\n');
  await page.keyboard.press('Control+s');
  await until('it is saved', async () => readFileSync(fixture.programFile, 'utf8') === `${SHORT_PROGRAM}# saved\n`);
  expect(readFileSync(fixture.cellFile, 'utf8')).toBe(EXAMPLE_CELL);
});

test('a click in the dialog to open files arrives, though the samples are loaded while it lasts', async () => {
  await append('# mine\n');
  await checkResult('passed');
  const release = await hold('**/api/v1/catalogue');
  await page.keyboard.press('Control+o');
  await page.getByTestId('open-server-cell').hover();
  await page.mouse.down();
  await release();
  await page.getByTestId('sample-delta').waitFor();
  await page.mouse.up();
  await expect.poll(() => page.getByTestId('cell-file').innerText()).toBe('mine.toml');
});

test('samples that could not be loaded are loaded again on request', async () => {
  await checkResult('passed');
  await page.route('**/api/v1/catalogue', (route) => route.abort('connectionrefused'));
  await page.keyboard.press('Control+o');
  await page.getByTestId('open-problem').waitFor();
  await page.unroute('**/api/v1/catalogue');
  await page.getByTestId('load-samples').click();
  await page.getByTestId('sample-delta').waitFor();
  await page.getByTestId('open-problem').waitFor({ state: 'hidden' });
});

test('a cell and its program are opened together', async () => {
  const other = EXAMPLE_CELL.replace(/^name = "[^"]*"/m, 'name = "other cell"');
  const program = 'HOME\nGET LP1 SLOT 3 WITH B\n';
  const file = (name: string, content: string) => ({ name, mimeType: 'text/plain', buffer: Buffer.from(content) });
  await page.keyboard.press('Control+o');
  const input = page.getByTestId('open-file');
  await input.setInputFiles([file('one.program', program), file('two.program', program)]);
  await page.getByTestId('open-problem').filter({ hasText: 'or a work cell with its program' }).waitFor();
  await input.setInputFiles([file('other.program', program), file('other.toml', other)]);
  await page.locator('dialog[open]').waitFor({ state: 'hidden' });
  await until('the program is shown', async () => (await text()).includes('GET LP1 SLOT 3 WITH B'));
  await expect.poll(() => page.getByTestId('cell-file').innerText()).toBe('other.toml, not on the server');
  await checkResult('passed');
});

test('a program is opened in the current cell, and undo returns to the previous one', async () => {
  await checkResult('passed');
  const before = await text();
  await page.getByRole('button', { name: 'Robot', exact: true }).click();
  await page.keyboard.press('Control+o');
  await page.getByTestId('open-file').setInputFiles({ name: 'other.program', mimeType: 'text/plain', buffer: Buffer.from('HOME\nGET LP1 SLOT 2 WITH B\n') });
  await page.locator('dialog[open]').waitFor({ state: 'hidden' });
  await until('the program is shown', async () => (await text()).includes('GET LP1 SLOT 2 WITH B'));
  await checkResult('passed');
  await expect.poll(() => page.getByTestId('cell-file').innerText()).toBe('mine.toml: Unsaved changes');
  await page.getByRole('button', { name: 'Undo' }).click();
  await until('the previous program is shown', async () => (await text()) === before);
  await checkResult('passed');
});

test('the draft of the files of the server remains while another cell is open', async () => {
  await append('# draft\n');
  await checkResult('passed');
  await page.keyboard.press('Control+o');
  await page.getByTestId('open-file').setInputFiles({ name: 'other.toml', mimeType: 'text/plain', buffer: Buffer.from(EXAMPLE_CELL) });
  await page.getByTestId('cell-download').waitFor();
  await editor().click();
  await page.keyboard.insertText('HOME\n');
  await until('it is edited', async () => (await page.getByTestId('cell-file').innerText()).includes('Unsaved'));
  await checkResult('no_motion');
  page.once('dialog', (dialog) => void dialog.accept());
  await reload(page);
  await checkResult('passed');
  await page.getByTestId('draft').filter({ hasText: 'were restored' }).waitFor();
  await expect.poll(() => page.getByTestId('cell-file').innerText()).toBe('mine.toml: Unsaved changes');
  await expect.poll(() => text()).toContain('# draft');
});

test('the list of shortcuts is that of the current view', async () => {
  await page.getByTestId('check-result').click();
  await page.keyboard.press('?');
  await page.getByRole('heading', { name: 'Keyboard shortcuts, cell view' }).waitFor();
  // Not a button at the end of the list, to which a small window would scroll, and which Enter would press.
  await expect.poll(() => page.evaluate(() => document.activeElement?.id)).toBe('help-title');
  const dialog = page.locator('dialog[open]');
  await expect.poll(() => dialog.innerText()).toContain('save, also in the editor');
  for (const foreign of ['next virtualization', '90 pixels', 'up by 1 mm']) await expect.poll(() => dialog.innerText()).not.toContain(foreign);
  await page.keyboard.press('Escape');
  await page.getByRole('button', { name: 'Robot', exact: true }).click();
  await page.locator('body').press('?');
  await page.getByRole('heading', { name: 'Keyboard shortcuts, robot view' }).waitFor();
  await expect.poll(() => page.locator('dialog[open]').innerText()).toContain('90 pixels');
  await page.keyboard.press('Escape');
});
