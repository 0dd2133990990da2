// The simulated controller: the robot of a host, seen in the studio while it moves.

import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { connect, type Socket } from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import type { Browser, Page } from 'playwright-core';
import { afterAll, beforeAll, expect, test } from 'vitest';
import { accessibilityViolations, browse, complaints, EXAMPLE_CELL, load, SHORT_PROGRAM, start, unhandled, until, visit, type Server } from './studio';

let browser: Browser;
let server: Server;
let page: Page;
let host: Socket;
let heard: string[];
const folder = mkdtempSync(join(tmpdir(), 'controller-'));

beforeAll(async () => {
  const cell = join(folder, 'mine.toml');
  writeFileSync(cell, EXAMPLE_CELL);
  writeFileSync(join(folder, 'mine.program'), SHORT_PROGRAM);
  [browser, server] = await Promise.all([browse(), start(['cell', 'serve', cell, '--listen', '127.0.0.1:0', '--speed', '0.5', '--studio', '--studio-port', '0'])]);
  page = await visit(browser);
  heard = complaints(page);
  await load(page, server.address);
});
afterAll(async () => {
  host?.destroy();
  await browser?.close();
  await server?.stop();
  rmSync(folder, { recursive: true, force: true });
});

const text = (id: string) => page.getByTestId(id).innerText();
const elapsed = async () => Number(await page.getByTestId('controller-time').getAttribute('data-elapsed'));

test('a robot is seen where its host moves it', async () => {
  const [, port] = /controller: 127\.0\.0\.1:(\d+)/.exec(server.output)!;
  await page.getByTestId('controller-waiting').waitFor();
  host = connect(Number(port), '127.0.0.1');
  let answers = '';
  host.on('data', (data) => (answers += data.toString()));
  await until('the host is connected', async () => /READY/.test(answers));
  await until('the host is listed', async () => (await text('controller-command')) === 'At rest');
  host.write('MOVE RA 900\nGET LP1 3 A\n');
  await until('the robot moves', async () => (await text('controller-command')) === 'GET LP1 3 A' && (await elapsed()) > 0);
  await expect.poll(() => text('controller-events')).toContain('GET LP1 3 A: Accepted, 4.032 s');
  await expect.poll(() => text('controller-events')).toMatch(/MOVE RA 900: Refused \(unreachable\): .*axis RA at 900/);
  // The view has the frames of the host: the arm turns.
  const origin = () => page.evaluate(() => (window as unknown as { jointplay: { probe: { cell: { origin(name: string): number[] | null } } } }).jointplay.probe.cell.origin('upper link 2'));
  const before = await origin();
  await until('the arm moves in the view', async () => JSON.stringify(await origin()) !== JSON.stringify(before));
  await until('the wafer is picked', async () => /Effector A\s+wafer/.test(await text('controller-axes')));
  await until('the motion has ended', async () => /GET LP1 3 A: Completed/.test(await text('controller-events')));
  expect(answers).toContain('COMPLETED 4.032 GET LP1 3 A');
  await expect.poll(() => accessibilityViolations(page)).toEqual([]);
  if (process.env.PICTURES) await page.screenshot({ path: `${process.env.PICTURES}/controller.png` });
  await page.getByTestId('controlled').getByRole('button', { name: 'Return to program' }).click();
  await expect.poll(() => page.getByTestId('controller-shown').isChecked()).toBe(false);
  host.destroy();
  await page.getByTestId('controller-waiting').waitFor();
  expect(unhandled(heard)).toEqual([]);
});
