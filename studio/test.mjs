// Builds the studio's page and tests it: types, logic, and in a real browser against the real server.
//
// Run by `cargo xtask page`. Everything it makes is in `studio/node_modules` and `target`;
// where this machine has no Chromium, Debian's is installed. With `--prepare` it only fetches these; without a word
// it builds the page to `target/page/built`, which the caller compares with the page in the repository, and tests what
// needs no server; with the path of the `jointplay` command it tests the rest.

import { spawnSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { resolve } from 'node:path';

const STUDIO = import.meta.dirname;
const ROOT = resolve(STUDIO, '..');
const HOME = resolve(ROOT, 'target/page');
const CHROMIUMS = ['/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'];

const say = (text) => console.log(`--- ${text}`);

function run(command, words, options = {}) {
  const { status, error } = spawnSync(command, words, { stdio: 'inherit', cwd: STUDIO, ...options });
  if (status === 0) return;
  say(`failed: ${command} ${words.join(' ')}${error ? `: ${error.message}` : ''}`);
  process.exit(1);
}

/** The page's packages, as the lock file says; installed anew only when that has changed. */
function packages() {
  const lock = createHash('sha256').update(readFileSync(resolve(STUDIO, 'package-lock.json'))).digest('hex');
  const stamp = resolve(STUDIO, 'node_modules/.installed');
  if (existsSync(stamp) && readFileSync(stamp, 'utf8') === lock) return;
  say('npm ci');
  run('npm', ['ci', '--no-progress'], { env: { ...process.env, npm_config_cache: resolve(HOME, 'npm') } });
  writeFileSync(stamp, lock);
}

/** A Chromium of this machine; Debian's, installed now, where there is none. */
function chromium() {
  const known = () => [process.env.CHROMIUM, ...CHROMIUMS].find((path) => path && existsSync(path));
  if (!known() && existsSync('/usr/bin/apt-get')) {
    say('no Chromium here: installing Debian’s by apt-get');
    const sudo = process.getuid?.() === 0 ? [] : ['sudo'];
    const apt = (...words) => run([...sudo, 'apt-get'][0], [...sudo, 'apt-get', ...words].slice(1), { env: { ...process.env, DEBIAN_FRONTEND: 'noninteractive' } });
    apt('update', '-qq');
    apt('install', '-y', '-qq', '--no-install-recommends', 'chromium');
  }
  const found = known();
  if (!found) {
    say('no Chromium found: install one, and name its path in CHROMIUM');
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
  say(`tested in the browser in ${seconds()}`);
} else {
  const scripts = [['build', '--', '--outDir', resolve(HOME, 'built')], ['check'], ['test']];
  for (const script of scripts) {
    say(script[0]);
    run('npm', ['run', '--silent', ...script]);
  }
  say(`built and checked in ${seconds()}`);
}
