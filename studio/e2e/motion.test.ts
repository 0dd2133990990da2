import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import type { Browser, Page } from 'playwright-core';
import { afterAll, afterEach, beforeAll, expect, test } from 'vitest';
import { COMMAND, browse, bytesOf, complaints, drawn, frames, load, serve, until, visit, type Server } from './studio';

let browser: Browser;
let server: Server;
let page: Page;
let heard: string[];

beforeAll(async () => {
  [browser, server] = await Promise.all([browse(), serve()]);
  page = await visit(browser);
  heard = complaints(page);
  await load(page, server.address);
  await drawn(page);
});
afterAll(async () => {
  await browser?.close();
  await server?.stop();
});
afterEach(() => {
  expect(heard.splice(0)).toEqual([]);
});

const sample = () => page.getByTestId('sample');
const at = async () => Number(await sample().getAttribute('data-sample'));
async function loaded(count: number): Promise<void> {
  await until(`${count} samples`, async () => (await sample().getAttribute('data-count')) === String(count));
}

test('a figure of the paper is selected, and its values equal those of the command line', async () => {
  await page.getByTestId('figure').selectOption('6');
  await loaded(777);
  await expect.poll(() => page.getByTestId('plot-linear').isVisible()).toBe(true);
  await expect.poll(() => page.getByTestId('plot-rods').count()).toBe(0);
  await page.getByTestId('all-plots').click();
  await page.getByTestId('scrub').fill('20');
  await drawn(page, 'Math.abs(pose.tilt.angle_rad - 2 * Math.PI / 180) < 1e-9');

  const folder = mkdtempSync(join(tmpdir(), 'studio-'));
  execFileSync(COMMAND, ['simulate', '--virtualization', 'polar', '--out', join(folder, 'study')], { stdio: 'ignore' });
  const [head, ...rows] = readFileSync(join(folder, 'study/samples-polar.csv'), 'utf8').trim().split('\n');
  rmSync(folder, { recursive: true });
  const names = head!.split(',');
  const row = rows[20]!.split(',').map(Number);
  for (const [column, name] of [['l1_m', 'l1_mm'], ['l2_m', 'l2_mm'], ['q1_m', 'q1_mm']] as const) {
    const shown = Number(await page.getByTestId(`value-${column}`).getAttribute('data-value'));
    expect(names).toContain(name);
    expect(shown * 1e3).toBeCloseTo(row[names.indexOf(name)]!, 9);
  }
});

test('the motion is controlled by the keyboard', async () => {
  await page.getByTestId('scrub').fill('0');
  await page.locator('body').press('ArrowRight');
  await expect.poll(() => at()).toBe(1);
  await page.locator('body').press('ArrowLeft');
  await page.locator('body').press('ArrowLeft');
  await expect.poll(() => at()).toBe(0);
  await page.locator('body').press(' ');
  await until('it plays', async () => (await at()) > 5);
  await page.locator('body').press(' ');
  const stopped = await at();
  await frames(page);
  await expect.poll(() => at()).toBe(stopped);
  await page.locator('body').press('End');
  await expect.poll(() => at()).toBe(776);
});

test('plots seek by click, zoom by drag and hide lines by the legend', async () => {
  const over = page.getByTestId('plot-rods').locator('.u-over');
  const box = (await over.boundingBox())!;
  await over.click({ position: { x: box.width / 2, y: box.height / 2 } });
  await expect.poll(async () => Math.abs((await at()) - 388)).toBeLessThan(6);
  await page.mouse.move(box.x + box.width * 0.25, box.y + 20);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width * 0.5, box.y + 25, { steps: 4 });
  await page.mouse.up();
  await page.getByRole('button', { name: 'Whole motion' }).click();
  const legend = page.getByTestId('plot-rods').getByRole('button', { name: 'q₁' });
  await legend.click();
  await expect.poll(() => legend.getAttribute('aria-pressed')).toBe('false');
  await legend.click();
});

test('a serpentine and a motion through key poses are computed', async () => {
  await page.getByTestId('motion').selectOption('serpentine');
  await loaded(777);
  await page.getByTestId('motion').selectOption('key-poses');
  await until('samples', async () => Number(await sample().getAttribute('data-count')) > 300);
  // Seven seconds, plotted over time: the middle of a plot is the middle of the time.
  await loaded(421);
  const over = page.getByTestId('plot-rods').locator('.u-over');
  const box = (await over.boundingBox())!;
  await over.click({ position: { x: box.width / 2, y: box.height / 2 } });
  await expect.poll(async () => Math.abs((await at()) - 210)).toBeLessThan(6);
  await page.getByTestId('export').click();
  const [figure] = await Promise.all([page.waitForEvent('download'), page.getByTestId('export-svg').click()]);
  const svg = (await bytesOf(figure)).toString('utf8');
  expect(svg).toContain('time [s]');
  expect(svg).not.toContain('>sample<');
  await page.getByRole('button', { name: 'Poses' }).click();
  const add = (await page.getByTestId('add-pose').boundingBox())!;
  expect(add.height).toBeLessThan(40);
  await page.getByLabel('seconds of pose 2').fill('1');
  await page.getByLabel('seconds of pose 2').press('Enter');
  await page.getByTestId('add-pose').click();
  await expect.poll(() => page.getByLabel('seconds of pose 5').isVisible()).toBe(true);
  await page.keyboard.press('Control+z');
  await until('the pose is removed', async () => (await page.getByLabel('seconds of pose 5').count()) === 0);
  await page.getByRole('button', { name: 'Poses' }).click();
});

test('an invalid motion is reported', async () => {
  await page.getByTestId('motion').selectOption('raster');
  await loaded(777);
  await page.getByRole('button', { name: 'Range' }).click();
  await page.getByTestId('azimuth-step').fill('7');
  await page.getByTestId('azimuth-step').press('Enter');
  await page.getByRole('alert').filter({ hasText: 'step' }).waitFor();
  // An empty field is no number: what was there comes back.
  await page.getByTestId('tilt-step').fill('');
  await page.getByTestId('tilt-step').press('Enter');
  await expect.poll(() => page.getByTestId('tilt-step').inputValue()).toBe('0.2');
  await expect.poll(() => page.getByRole('alert').filter({ hasText: 'null' }).count()).toBe(0);
  await page.getByTestId('azimuth-step').fill('10');
  await page.getByTestId('azimuth-step').press('Enter');
  await loaded(777);
  await page.getByRole('button', { name: 'Range' }).click();
  // The browser itself logs that the server refused.
  heard.splice(0, heard.length, ...heard.filter((line) => !line.includes('422')));
});

test('time series and plots are exported', async () => {
  const take = async (item: string) => {
    await page.getByTestId('export').click();
    const [download] = await Promise.all([page.waitForEvent('download'), page.getByTestId(item).click()]);
    return bytesOf(download);
  };
  const csv = (await take('export-csv')).toString().trim().split('\n');
  expect(csv).toHaveLength(778);
  expect(csv[0]).toContain('q1_m');
  const shown = await page.locator('figure[data-testid^=plot-]').count();
  expect(shown).toBeGreaterThan(4);
  const svg = (await take('export-svg')).toString();
  expect(svg.match(/<g transform/g)).toHaveLength(shown);
  const png = await take('export-png');
  expect(png.subarray(1, 4).toString()).toBe('PNG');
  expect([png.readUInt32BE(16), png.readUInt32BE(20)]).toEqual([1440, 720 * shown]);
  // Parquet is offered by servers that write it, and by no others.
  const robot = (await (await fetch(`${server.address}api/v1/robot`)).json()) as { series_formats: string[] };
  if (robot.series_formats.includes('parquet')) {
    const bytes = await take('export-parquet');
    for (const mark of [bytes.subarray(0, 4), bytes.subarray(-4)]) expect(mark.toString()).toBe('PAR1');
  } else await expect.poll(() => page.getByTestId('export-parquet').count()).toBe(0);
});

test('Parquet export is offered only by servers that support it', async () => {
  const other = await page.context().newPage();
  try {
    await other.route('**/api/v1/robot', async (route) => {
      const robot = (await (await route.fetch()).json()) as object;
      await route.fulfill({ json: { ...robot, series_formats: ['csv'] } });
    });
    await load(other, server.address);
    await drawn(other);
    await other.getByTestId('export').click();
    await other.getByTestId('export-csv').waitFor();
    await expect.poll(() => other.getByTestId('export-parquet').count()).toBe(0);
  } finally {
    await other.close();
  }
});

test('the recording of a motion has the duration of the motion', async () => {
  await page.getByTestId('motion').selectOption('key-poses');
  await page.getByRole('button', { name: 'Poses' }).click();
  for (const [pose, seconds] of [[2, '1'], [3, '1'], [4, '1']] as const) {
    await page.getByLabel(`seconds of pose ${pose}`).fill(seconds);
    await page.getByLabel(`seconds of pose ${pose}`).press('Enter');
  }
  await loaded(181);
  await page.getByRole('button', { name: 'Poses' }).click();
  await page.getByTestId('export').click();
  const begun = Date.now();
  const [film] = await Promise.all([page.waitForEvent('download'), page.getByTestId('export-video').click()]);
  const took = (Date.now() - begun) / 1000;
  await expect.poll(() => at()).toBe(180);
  expect(film.suggestedFilename()).toMatch(/^motion\.(webm|mp4)$/);
  const bytes = (await bytesOf(film)).toString('base64');
  const played = await page.evaluate(async (base64) => {
    const blob = new Blob([Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0))]);
    const video = document.createElement('video');
    video.src = URL.createObjectURL(blob);
    video.muted = true;
    await new Promise((ready, failed) => {
      video.onloadeddata = ready;
      video.onerror = () => failed(new Error(video.error?.message));
    });
    // A streamed film has its length only at its end.
    video.currentTime = 1e6;
    await new Promise((ready) => (video.onseeked = ready));
    return { seconds: video.currentTime, width: video.videoWidth };
  }, bytes);
  expect(played.width).toBeGreaterThan(300);
  // Real time, three seconds; a machine that draws in software and has other work may need longer.
  expect(played.seconds).toBeGreaterThan(2.5);
  expect(played.seconds).toBeLessThan(took + 0.5);
  await page.getByTestId('motion').selectOption('raster');
  await loaded(777);
});

test('a link restores motion and sample', async () => {
  await page.getByTestId('scrub').fill('123');
  await until('the link contains the sample', () => page.evaluate(() => window.location.hash.includes('sample=123')));
  const link = page.url();
  await page.goto('about:blank');
  await load(page, link);
  await loaded(777);
  await until('the sample is shown', async () => (await at()) === 123);
});
