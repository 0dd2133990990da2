// The module in Node: `node crates/jointplay-wasm/js/test.mjs`.

import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import * as jointplay from './dist/jointplay.js';
import { check } from './check.mjs';

const here = (name) => readFile(new URL(name, import.meta.url));
const module = await jointplay.load(await here('dist/jointplay.wasm'));
assert.deepEqual(WebAssembly.Module.imports(module), [], 'the module needs nothing');
const cases = JSON.parse(await here('native.json'));
assert.deepEqual(check(jointplay, module, cases), []);
assert.ok(cases.length > 150 && cases.some(({ result }) => result.kind === 'infeasible'));
// The comparison itself: a number off by more than the bound is found.
const changed = structuredClone(cases.slice(0, 1));
changed[0].result[0] += 1e-11;
assert.equal(check(jointplay, module, changed).length, 1);

const { Robot } = jointplay;
const { robot } = cases[0];
const refused = (call, kind, message) => assert.throws(call, (error) => error.kind === kind && message.test(error.message));
const paper = new Robot(module, robot);
refused(() => new Robot(module, { ...robot, working_height_m: NaN }), 'invalid', /working height is NaN/);
refused(() => new Robot(module, { ...robot, limbs: [robot.limbs[0], robot.limbs[0], robot.limbs[0]] }), 'invalid', /lie on one line/);
refused(() => paper.inverse({ azimuth_rad: 0, angle_rad: 0.1 }, 0.5), 'infeasible', /up to 0\.026/);
refused(() => paper.forward([0.5, Infinity, 0.5], { virtualization: 'polar' }), 'invalid', /a rod length is inf/);
refused(() => paper.forward([0.5, 0.5], { virtualization: 'polar' }), 'invalid', /5 numbers are needed, got 4/);
refused(() => paper.forward([0.5, 0.5, '0.5'], { virtualization: 'polar' }), 'invalid', /5 numbers are needed/);
refused(() => paper.forward([0.5, 0.5, 0.5], { virtualization: 'square' }), 'invalid', /got square/);
refused(() => paper.forward([0.5, 0.5, 0.5], { virtualization: 'polar', solver: 'magic' }), 'invalid', /got magic/);
refused(() => paper.forward([0.5, 0.5001, 0.5], { virtualization: 'polar', solver: 'newton', max_iterations: 0 }), 'infeasible', /did not converge/);
refused(() => paper.forward([0.5, 0.5, 0.5], { virtualization: 'polar', characteristic_length_m: -1 }), 'invalid', /characteristic length/);
// Beyond the limits where they are not checked; robots do not share anything.
const free = new Robot(module, { ...robot, check_limits: false });
assert.equal(free.inverse({ azimuth_rad: 0, angle_rad: 0.1 }, 0.5).length, 3);
refused(() => paper.inverse({ azimuth_rad: 0, angle_rad: 0.1 }, 0.5), 'infeasible', /up to/);
console.log(`${cases.length} cases agree with the library within 1e-12`);
