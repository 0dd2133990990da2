// The screenshots of the documentation, in docs/figures: `npm run figures`, with target/debug/jointplay. Look at them afterwards.

import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import type { Page } from 'playwright-core';
import { test } from 'vitest';
import { COMMAND, EXAMPLE_CELL, ROOT, browse, cellFixture, drawn, frames, load, partNames, serve, until, visit, waitForCheck } from './studio';

const PROGRAM = `# One wafer through aligner and process station.
HOME
TRANSFER LP1 SLOT 1 TO ALIGN WITH A
TRANSFER ALIGN TO PM1 WITH A
TRANSFER PM1 TO LP2 SLOT 1 WITH B
HOME
`;

async function save(page: Page, name: string): Promise<void> {
  await until('the motion is loaded', async () => (await page.getByTestId('loading').count()) === 0);
  // Pictures and texts have settled after some frames.
  await frames(page, 60);
  // The picture at rest has the full resolution and occlusion.
  await page.waitForTimeout(4000);
  await page.screenshot({ path: resolve(ROOT, 'docs/figures', `${name}.png`) });
}

test('the robot and its motion', async () => {
  const [browser, server] = await Promise.all([browse(), serve()]);
  const page = await visit(browser, { deviceScaleFactor: 1 });
  await load(page, `${server.address}#pose=tilt,0,1.5,500,axis&model=polar,newton,paper&play=500&show=joints,arrows,frames,labels`);
  await drawn(page, 'Math.abs(pose.tilt.angle_rad - 1.5 * Math.PI / 180) < 1e-9');
  await save(page, 'studio');
  await page.goto('about:blank');
  await load(page, server.address);
  await drawn(page);
  await page.getByTestId('figure').selectOption('6');
  await until('samples', async () => Number(await page.getByTestId('sample').getAttribute('data-count')) > 0);
  await page.getByTestId('scrub').fill('300');
  await save(page, 'studio-motion');
  await browser.close();
  await server.stop();
});

test('the robot as a picture for publications', async () => {
  const [browser, server] = await Promise.all([browse(), serve()]);
  const page = await visit(browser, { deviceScaleFactor: 1, viewport: { width: 1400, height: 800 } });
  await load(page, `${server.address}#pose=tilt,20,1.5,500,axis&model=polar,newton,paper&play=400&show=joints,labels`);
  await drawn(page, 'Math.abs(pose.tilt.angle_rad - 1.5 * Math.PI / 180) < 1e-9');
  // The panels would narrow the view.
  await page.getByRole('button', { name: 'Close this explanation' }).click();
  await page.keyboard.press('b');
  await page.getByRole('button', { name: 'Platform', exact: true }).click();
  await page.getByTestId('export').click();
  await page.getByTestId('picture-size').selectOption('other');
  for (const [key, value] of [['width', '1600'], ['height', '800'], ['dpi', '192']] as const) {
    await page.getByTestId(`picture-${key}`).fill(value);
    await page.getByTestId(`picture-${key}`).press('Tab');
  }
  const [download] = await Promise.all([page.waitForEvent('download'), page.getByTestId('export-view').click()]);
  await download.saveAs(resolve(ROOT, 'docs/figures/robot-play.png'));
  await browser.close();
  await server.stop();
});

test('a tool of parts', async () => {
  const folder = mkdtempSync(join(tmpdir(), 'studio-'));
  const guide = readFileSync(resolve(ROOT, 'docs/how-to/build-a-cell.md'), 'utf8');
  const block = (kind: string) => new RegExp(`\`\`\`${kind}\\n([\\s\\S]*?)\`\`\``).exec(guide)![1]!;
  writeFileSync(join(folder, 'tool.toml'), block('toml').replaceAll('part = "blade"', 'part = "fork-blade"'));
  writeFileSync(join(folder, 'tool.program'), block('program'));
  const [browser, server] = await Promise.all([browse(), serve(0, ['--cell', join(folder, 'tool.toml')])]);
  const page = await visit(browser, { deviceScaleFactor: 1, viewport: { width: 1440, height: 900 } });
  await load(page, server.address);
  await waitForCheck(page, 'passed');
  await until('the cell is drawn', async () => (await partNames(page)).length > 0 && (await page.evaluate(() => window.jointplay.probe.cellFrames > 0)));
  await page.getByTestId('cell-time').fill('11.4');
  await save(page, 'studio-tool');
  await browser.close();
  await server.stop();
  rmSync(folder, { recursive: true });
});

test('a mechanism', async () => {
  const [browser, server] = await Promise.all([browse(), serve(0, ['gpr-mechanism'])]);
  const page = await visit(browser, { deviceScaleFactor: 1 });
  await load(page, server.address);
  await page.getByTestId('redundant').getByRole('button').first().click();
  await page.getByText('Highlighted:').scrollIntoViewIfNeeded();
  await save(page, 'studio-mechanism');
  await browser.close();
  await server.stop();
});

test('the cell', async () => {
  const fixture = await cellFixture(PROGRAM);
  const page = await visit(fixture.browser, { deviceScaleFactor: 1 });
  await load(page, fixture.server.address);
  await waitForCheck(page, 'passed');
  await until('the cell is drawn', async () => (await partNames(page)).length > 0 && (await page.evaluate(() => window.jointplay.probe.cellFrames > 0)));

  // A wafer above its slot in the station that tilts.
  await page.getByRole('tab', { name: 'Station', exact: true }).click();
  await page.getByTestId('jog-station').selectOption('LP2');
  await page.getByTestId('jog-stop').uncheck();
  await page.getByTestId('jog-in').click();
  await until('the arm is at the slot', async () => Math.abs(Number(await page.getByTestId('field-jog-z').inputValue())) < 1e-6);
  await page.getByTestId('field-jog-z').fill('3');
  await page.getByTestId('field-jog-z').press('Enter');
  await until('the pose is checked', async () => (await page.getByTestId('jog-check').getAttribute('data-state')) === 'passed');
  await save(page, 'studio-cell-jog');
  await page.getByTestId('jog-release').click();

  // The handles of a station, and the plots.
  await page.getByRole('tab', { name: 'Parts' }).click();
  await page.getByTestId('parts').getByRole('button', { name: /^ALIGN/ }).click();
  await page.getByTestId('cell-plots-toggle').click();
  await page.getByTestId('cell-time').fill('9.5');
  await save(page, 'studio-cell-plots');
  await page.getByTestId('cell-plots-toggle').click();

  // A wall in the path of an arm.
  writeFileSync(fixture.cellFile, EXAMPLE_CELL);
  await page.getByRole('tab', { name: 'Cell file' }).click();
  await page.getByTestId('text-cell').locator('.cm-content').click();
  await page.keyboard.press('Control+a');
  await page.keyboard.insertText(EXAMPLE_CELL.replace('position_mm = [100.0, -600.0, 500.0]', 'position_mm = [-330.0, 330.0, 500.0]'));
  await waitForCheck(page, 'failed');
  await page.getByTestId('violations').getByRole('button').first().click();
  await page.getByTestId('current-violations').filter({ hasText: 'wall' }).waitFor();
  await page.getByRole('tab', { name: 'Program' }).click();
  await save(page, 'studio-cell');
  await fixture.close();
});

test('a report', async () => {
  const fixture = await cellFixture(PROGRAM);
  const slow = join(fixture.folder, 'slow.program');
  writeFileSync(slow, `SPEED 70 %\n${PROGRAM}`);
  const file = join(fixture.folder, 'report.html');
  execFileSync(COMMAND, ['cell', 'report', fixture.cellFile, '--before', slow, '--out', file]);
  const page = await visit(fixture.browser, { deviceScaleFactor: 1, viewport: { width: 1200, height: 1480 } });
  await page.goto(pathToFileURL(file).href);
  await save(page, 'cell-report');
  await fixture.close();
});
