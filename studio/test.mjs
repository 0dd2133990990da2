// Builds and tests the page of the studio: types, unit tests, and browser tests with a running server.
//
// Run by `cargo xtask page`. All output is in `studio/node_modules` and `target`; if there is no Chromium, that of Debian is installed.
// With `--prepare`, only the packages are installed. Without an argument, the page is built to `target/page/built`, which the caller
// compares with the page in the repository, and all tests without a server run. With the path of the `jointplay` command, the browser tests run.

import { spawnSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { resolve } from 'node:path';

const STUDIO = import.meta.dirname;
const ROOT = resolve(STUDIO, '..');
const HOME = resolve(ROOT, 'target/page');
const CHROMIUMS = ['/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'];

const log = (text) => console.log(`--- ${text}`);

function run(command, words, options = {}) {
  const { status, error } = spawnSync(command, words, { stdio: 'inherit', cwd: STUDIO, ...options });
  if (status === 0) return;
  log(`failed: ${command} ${words.join(' ')}${error ? `: ${error.message}` : ''}`);
  process.exit(1);
}

/** Installs the packages of the lock file, if it has changed since the last installation. */
function packages() {
  const lock = createHash('sha256').update(readFileSync(resolve(STUDIO, 'package-lock.json'))).digest('hex');
  const stamp = resolve(STUDIO, 'node_modules/.installed');
  if (existsSync(stamp) && readFileSync(stamp, 'utf8') === lock) return;
  log('npm ci');
  run('npm', ['ci', '--no-progress'], { env: { ...process.env, npm_config_cache: resolve(HOME, 'npm') } });
  writeFileSync(stamp, lock);
}

/** Path of Chromium; installs that of Debian if there is none. */
function chromium() {
  const known = () => [process.env.CHROMIUM, ...CHROMIUMS].find((path) => path && existsSync(path));
  if (!known() && existsSync('/usr/bin/apt-get')) {
    log('no Chromium found: installing that of Debian by apt-get');
    const sudo = process.getuid?.() === 0 ? [] : ['sudo'];
    const env = { ...process.env, DEBIAN_FRONTEND: 'noninteractive' };
    // One program at a time: another may be installing a C# compiler.
    const apt = (...words) => run('flock', [resolve(ROOT, 'target/apt.lock'), ...sudo, 'apt-get', ...words], { env });
    apt('update', '-qq');
    apt('install', '-y', '-qq', '--no-install-recommends', 'chromium');
  }
  const found = known();
  if (!found) {
    log('no Chromium found: install it and set CHROMIUM to its path');
    process.exit(1);
  }
  return found;
}

mkdirSync(HOME, { recursive: true });
const start = Date.now();
const seconds = () => `${((Date.now() - start) / 1000).toFixed(0)} s`;
packages();
const browser = chromium();
const [word] = process.argv.slice(2);
if (word === '--prepare') process.exit(0);
if (word) {
  run('npm', ['run', '--silent', 'e2e'], { env: { ...process.env, JOINTPLAY_COMMAND: resolve(word), CHROMIUM: browser } });
  log(`tested in the browser in ${seconds()}`);
} else {
  const scripts = [['build', '--', '--outDir', resolve(HOME, 'built')], ['playground', '--', '--outDir', resolve(HOME, 'playground')], ['check'], ['workflows'], ['test']];
  for (const script of scripts) {
    log(script[0]);
    run('npm', ['run', '--silent', ...script]);
  }
  log(`built and checked in ${seconds()}`);
}
