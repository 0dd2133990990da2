// Each view of the studio in Firefox, over WebDriver BiDi: `npm run firefox`, with JOINTPLAY_COMMAND a built command.
//
// The tests in `e2e/` are thorough and use Chromium; these follow one path through each view in another browser:
// a mechanism is opened, analysed, relieved and exported; a cell is opened, broken, fixed and exported; a robot is edited, compared and saved.

import { strict as assert } from 'node:assert';
import { spawn } from 'node:child_process';
import { existsSync, mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import puppeteer from 'puppeteer-core';

const ROOT = resolve(import.meta.dirname, '../..');
const COMMAND = process.env.JOINTPLAY_COMMAND ?? resolve(ROOT, 'target/debug/jointplay');
const FIREFOX = [process.env.FIREFOX, '/usr/bin/firefox-esr', '/usr/bin/firefox'].find((path) => path && existsSync(path));
const TIMEOUT_MS = Number(process.env.TIMEOUT_S ?? 120) * 1000;
if (!FIREFOX) throw new Error('no Firefox found: install firefox-esr, or name it in FIREFOX');

async function until(what, asked) {
  const end = Date.now() + TIMEOUT_MS;
  for (;;) {
    const found = await asked();
    if (found) return found;
    if (Date.now() > end) throw new Error(`timeout while waiting for: ${what}`);
    await new Promise((wait) => setTimeout(wait, 50));
  }
}

function serve(words) {
  const server = spawn(COMMAND, ['studio', '--no-open', '--port', '0', ...words], { stdio: ['ignore', 'pipe', 'inherit'] });
  const stop = () => new Promise((done) => (server.exitCode === null ? (server.on('exit', done), server.kill('SIGINT')) : done()));
  return new Promise((found, failed) => {
    let output = '';
    server.stdout.on('data', (text) => {
      output += text;
      const match = /http:\/\/127\.0\.0\.1:\d+\//.exec(output);
      if (match) found({ address: match[0], stop });
    });
    server.on('exit', (code) => failed(new Error(`${COMMAND} studio ended with ${code}: ${output}`)));
  });
}

/** A display for Firefox, whose software rendering of 3D needs one, also without a window. */
function display() {
  if (process.env.DISPLAY) return Promise.resolve({ name: process.env.DISPLAY, stop: () => undefined });
  const server = spawn('Xvfb', ['-displayfd', '3', '-screen', '0', '1600x1200x24', '-nolisten', 'tcp'], { stdio: ['ignore', 'ignore', 'ignore', 'pipe'] });
  return new Promise((found, failed) => {
    server.stdio[3].once('data', (number) => found({ name: `:${String(number).trim()}`, stop: () => server.kill() }));
    server.on('error', () => failed(new Error('no display and no Xvfb found: install xvfb, or set DISPLAY')));
  });
}

const screen = await display();
const folder = mkdtempSync(join(tmpdir(), 'studio-firefox-'));
const downloads = mkdtempSync(join(tmpdir(), 'studio-downloads-'));
const browser = await puppeteer.launch({
  browser: 'firefox',
  protocol: 'webDriverBiDi',
  executablePath: FIREFOX,
  headless: true,
  env: { ...process.env, DISPLAY: screen.name, LIBGL_ALWAYS_SOFTWARE: '1' },
  extraPrefsFirefox: {
    'browser.download.folderList': 2,
    'browser.download.dir': downloads,
    'browser.helperApps.neverAsk.saveToDisk': 'application/octet-stream,application/toml,text/csv,image/svg+xml,text/plain',
    // Firefox renders by software only with this setting.
    'webgl.force-enabled': true,
    'ui.prefersReducedMotion': 1,
  },
});

/** Words of the command line choose the paths whose titles contain one of them. */
const chosen = process.argv.slice(2);

/** Opens a page of a server, follows a path, and requires that the console has no errors. */
async function at(title, words, path) {
  if (chosen.length > 0 && !chosen.some((word) => title.includes(word))) return;
  const begun = Date.now();
  const server = await serve(words);
  const page = await browser.newPage();
  const heard = [];
  page.on('console', (message) => message.type() === 'error' && heard.push(message.text()));
  page.on('pageerror', (error) => heard.push(String(error)));
  try {
    await page.setViewport({ width: 1440, height: 900 });
    await page.goto(server.address);
    await until('the scripts have run', () => page.evaluate(() => 'jointplay' in window));
    const by = (testid) => `[data-testid="${testid}"]`;
    await path({
      page,
      by,
      click: (testid) => page.locator(by(testid)).setTimeout(TIMEOUT_MS).click(),
      shows: (testid, text) => until(`${testid} shows ${text}`, () => page.evaluate((selector, text) => [...document.querySelectorAll(selector)].some((one) => one.textContent.includes(text)), by(testid), text)),
      has: (testid) => until(testid, () => page.evaluate((selector) => document.querySelector(selector) !== null, by(testid))),
      button: async (name) => (await until(`button ${name}`, () => page.$(`::-p-aria([name="${name}"][role="button"])`))).click(),
      async type(testid, text) {
        const field = await until(testid, () => page.$(by(testid)));
        await field.click({ count: 3 });
        await page.keyboard.type(text);
        await page.keyboard.press('Enter');
      },
      /** Replaces the text of an editor. */
      async write(text) {
        const editor = await until('the editor', () => page.$('.cm-content'));
        await editor.click();
        await page.keyboard.down('Control');
        await page.keyboard.press('a');
        await page.keyboard.up('Control');
        await page.keyboard.type(text);
      },
      async exported(what, does) {
        const before = new Set(readdirSync(downloads));
        await does();
        const name = await until(`the file ${what}`, () => readdirSync(downloads).find((one) => !before.has(one) && one.endsWith(what)));
        return until(`the content of ${what}`, () => {
          const bytes = readFileSync(join(downloads, name));
          return bytes.length > 0 && bytes;
        });
      },
    });
    assert.deepEqual(heard.filter((line) => !/status|NS_BINDING_ABORTED|HTTP\/1\.1 4(04|09|22)/.test(line)), []);
    console.log(`ok   ${title} (${((Date.now() - begun) / 1000).toFixed(1)} s)`);
  } catch (error) {
    await page.screenshot({ path: join(tmpdir(), 'studio-firefox-failed.png') }).catch(() => undefined);
    throw new Error(`${title}: ${error.message}`, { cause: error });
  } finally {
    await page.close();
    await server.stop();
  }
}

try {
  console.log(`${await browser.version()}, ${COMMAND}`);
  const robot = join(folder, 'mine.toml');
  const text = readFileSync(resolve(ROOT, 'crates/jointplay-format/robots/gpr.toml'), 'utf8');
  writeFileSync(robot, text);
  await at('a robot: edit, compare models, save, export', ['--robot', robot], async ({ page, click, has, shows, type, exported }) => {
    await until('a picture', () => page.evaluate(() => window.jointplay.probe.frames > 0));
    await click('edit-robot');
    await has('text-robot');
    await type('field-socket-radius', '100');
    await until('the robot follows', () => page.evaluate(() => document.querySelector('[data-testid="text-robot"]').textContent.includes('socket_radius_mm = 100.0')));
    await page.select('[data-testid="figure"]', '6');
    await until('777 samples', () => page.evaluate(() => document.querySelector('[data-testid="sample"]')?.dataset.count === '777'));
    await click('all-plots');
    await click('plot-menu');
    await click('compare-planar');
    await click('plot-menu-close');
    await shows('plot-shift', 'planar');
    const svg = await exported('view.svg', async () => {
      await click('export');
      await click('export-vectors');
    });
    assert.ok(/<image[^>]*image\/png/.test(svg) && /<text[^>]*>Play scale 500× · polar<\/text>/.test(svg), 'a picture with vectors');
    await click('robot-save');
    await until('it is saved', () => readFileSync(robot, 'utf8') === text.replaceAll('93.218', '100.0'));
  });

  await at('a mechanism: open, analyse, relieve, export', [], async ({ page, click, has, shows, button, exported }) => {
    await button('Mechanism');
    await click('entry-gpr-mechanism');
    await shows('mechanism-name', 'as a mechanism');
    await has('m-finite');
    await until('a picture', () => page.evaluate(() => window.jointplay.probe.mechanismFrames > 0));
    await click('suggest');
    await click('apply-0');
    const toml = await exported('.toml', () => click('mechanism-download'));
    assert.match(toml.toString(), /\[\[virtual_joint\]\]/);
  });

  const [cell, program] = [join(folder, 'cell.toml'), join(folder, 'cell.program')];
  writeFileSync(cell, readFileSync(resolve(ROOT, 'crates/jointplay-format/cells/example.toml'), 'utf8'));
  writeFileSync(program, 'HOME\nGET LP1 SLOT 1 WITH A\nPUT ALIGN WITH A\nHOME\n');
  await at('a cell: open, break, fix, export', ['--cell', cell], async ({ page, click, shows, write, exported }) => {
    const state = (wanted) => until(`check result ${wanted}`, () => page.evaluate((wanted) => document.querySelector('[data-testid="check-result"]')?.dataset.state === wanted, wanted));
    await state('passed');
    await until('a picture', () => page.evaluate(() => window.jointplay.probe.cellFrames > 0));
    await write('HOME\nGET LP9 SLOT 1 WITH A\n');
    await state('refused');
    await shows('diagnostics', 'LP9');
    await write('HOME\nGET LP1 SLOT 2 WITH A\nPUT ALIGN WITH A\nHOME\n');
    await state('passed');
    const csv = await exported('.csv', async () => {
      await click('cell-export');
      await click('cell-export-csv');
    });
    assert.match(csv.toString().split('\n')[0], /^time_s,/);
  });
} finally {
  await browser.close();
  screen.stop();
  rmSync(folder, { recursive: true });
  rmSync(downloads, { recursive: true });
}
