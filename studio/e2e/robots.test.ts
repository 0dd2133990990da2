// Other robots than that of the paper: with mesh files, and opened by links of another robot.

import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import type { Browser, Page } from 'playwright-core';
import { afterAll, beforeAll, expect, test } from 'vitest';
import { ROOT, browse, complaints, drawn, load, reload, serve, until, visit } from './studio';

let browser: Browser;
let folder: string;

beforeAll(async () => {
  browser = await browse();
  folder = mkdtempSync(join(tmpdir(), 'studio-'));
});
afterAll(async () => {
  await browser?.close();
  rmSync(folder, { recursive: true });
});

const PAPER = readFileSync(resolve(ROOT, 'crates/jointplay-format/robots/gpr.toml'), 'utf8');

/** The paper's robot, with shapes. */
function robot(shapes: Record<string, string>, change: (text: string) => string = (text) => text): string {
  const lines = Object.entries(shapes).map(([key, file]) => `${key} = "${file}"\n`);
  const file = join(folder, 'robot.toml');
  writeFileSync(file, change(PAPER.replace('kind = "gpr"\n', `kind = "gpr"\n${lines.join('')}`)));
  return file;
}

async function at(robotFile: string, does: (page: Page, address: string, heard: string[]) => Promise<void>): Promise<void> {
  const server = await serve(0, ['--robot', robotFile]);
  const page = await visit(browser);
  const heard = complaints(page);
  try {
    await does(page, server.address, heard);
    expect(heard).toEqual([]);
  } finally {
    await page.context().close();
    await server.stop();
  }
}

/** The corners of a box whose middle is the origin, and its twelve triangles. */
function box([a, b, c]: [number, number, number]) {
  const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((i) => [i & 1 ? a / 2 : -a / 2, i & 2 ? b / 2 : -b / 2, i & 4 ? c / 2 : -c / 2]);
  const faces = [0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5];
  return { corners, faces };
}

function stl(size: [number, number, number]): string {
  const { corners, faces } = box(size);
  const facets = Array.from({ length: 12 }, (_, i) => {
    const points = faces.slice(3 * i, 3 * i + 3).map((k) => `vertex ${corners[k]!.join(' ')}`);
    return `facet normal 0 0 0\nouter loop\n${points.join('\n')}\nendloop\nendfacet`;
  });
  return `solid box\n${facets.join('\n')}\nendsolid box\n`;
}

function obj(size: [number, number, number]): string {
  const { corners, faces } = box(size);
  const lines = corners.map((corner) => `v ${corner.join(' ')}`);
  for (let i = 0; i < 12; i++) lines.push(`f ${faces.slice(3 * i, 3 * i + 3).map((k) => k + 1).join(' ')}`);
  return lines.join('\n');
}

/** glTF in metres, with y up as its standard has it. */
function gltf([x, y, z]: [number, number, number], uri?: (bytes: Buffer) => string): { json: string; bytes: Buffer } {
  const { corners, faces } = box([x / 1000, z / 1000, y / 1000]);
  const bytes = Buffer.concat([Buffer.from(new Float32Array(corners.flat()).buffer), Buffer.from(new Uint16Array(faces).buffer)]);
  const half = [x / 2000, z / 2000, y / 2000];
  const json = JSON.stringify({
    asset: { version: '2.0' },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 }, indices: 1 }] }],
    accessors: [
      { bufferView: 0, componentType: 5126, count: 8, type: 'VEC3', min: half.map((v) => -v), max: half },
      { bufferView: 1, componentType: 5123, count: 36, type: 'SCALAR' },
    ],
    bufferViews: [
      { buffer: 0, byteOffset: 0, byteLength: 96 },
      { buffer: 0, byteOffset: 96, byteLength: 72 },
    ],
    buffers: [{ byteLength: bytes.length, ...(uri ? { uri: uri(bytes) } : {}) }],
  });
  return { json, bytes };
}

function glb(size: [number, number, number]): Buffer {
  const { json, bytes } = gltf(size);
  const chunk = (kind: number, data: Buffer, pad: number) => {
    const padded = Buffer.concat([data, Buffer.alloc((4 - (data.length % 4)) % 4, pad)]);
    const head = Buffer.alloc(8);
    head.writeUInt32LE(padded.length, 0);
    head.writeUInt32LE(kind, 4);
    return Buffer.concat([head, padded]);
  };
  const chunks = Buffer.concat([chunk(0x4e4f534a, Buffer.from(json), 0x20), chunk(0x004e4942, bytes, 0)]);
  const head = Buffer.alloc(12);
  head.write('glTF', 0);
  head.writeUInt32LE(2, 4);
  head.writeUInt32LE(12 + chunks.length, 8);
  return Buffer.concat([head, chunks]);
}

const shown = (page: Page) => page.evaluate(() => window.jointplay.probe.meshExtents);

test('meshes of the robot file are displayed at their size', async () => {
  writeFileSync(join(folder, 'base.stl'), stl([320, 260, 30]));
  writeFileSync(join(folder, 'base.obj'), obj([300, 240, 20]));
  writeFileSync(join(folder, 'platform.glb'), glb([260, 240, 12]));
  const data = (bytes: Buffer) => `data:application/octet-stream;base64,${bytes.toString('base64')}`;
  writeFileSync(join(folder, 'platform.gltf'), gltf([250, 230, 10], data).json);
  const cases = [
    ['base.stl', [320, 260, 30], 'platform.glb', [260, 240, 12]],
    ['base.obj', [300, 240, 20], 'platform.gltf', [250, 230, 10]],
  ] as const;
  for (const [base, baseSize, platform, platformSize] of cases)
    await at(robot({ base_mesh: base, platform_mesh: platform }), async (page, address) => {
      await load(page, `${address}#pose=rods,500,500,500&play=1`);
      await drawn(page);
      await until('both shapes', async () => Object.keys(await shown(page)).length === 2);
      const found = await shown(page);
      baseSize.forEach((size, i) => expect(found['base']![i]).toBeCloseTo(size, 3));
      platformSize.forEach((size, i) => expect(found['platform']![i]).toBeCloseTo(size, 3));
    });
});

test('an invalid mesh is reported, and the generated part stays', async () => {
  writeFileSync(join(folder, 'base.stl'), 'solid nothing\nendsolid nothing\n');
  await at(robot({ base_mesh: 'base.stl' }), async (page, address) => {
    await load(page, address);
    await drawn(page);
    await page.getByRole('alert').filter({ hasText: 'The mesh of the base cannot be displayed: the file has no triangles.' }).waitFor();
    await expect.poll(() => shown(page)).toEqual({});
  });
});

test('a link of another robot is reported, and stored settings are separate for each robot', async () => {
  const other = (text: string) => text.replace(/name = "[^"]*"/, 'name = "Taller, “2nd” & last"').replace("height_mm = 500.0", "height_mm = 480.0");
  let link = '';
  await at(robot({}), async (page, address) => {
    await load(page, `${address}#pose=tilt,20,1,490,axis`);
    await drawn(page);
    await page.getByRole('button', { name: 'Copy link' }).click();
    await until('the link names the robot', () => page.evaluate(() => window.location.hash.includes('robot=GPR%20of%20the%20paper,')));
    link = new URL(page.url()).hash;
    await reload(page);
    await drawn(page, 'Math.abs(pose.tilt.angle_rad - Math.PI / 180) < 1e-9');
    await expect.poll(() => page.getByTestId('foreign-robot').count()).toBe(0);
  });
  await at(robot({}, other), async (page, address) => {
    await load(page, address + link);
    await page.getByTestId('foreign-robot').filter({ hasText: 'another robot, “GPR of the paper”' }).waitFor();
    await drawn(page, 'Math.abs(pose.tilt.angle_rad - Math.PI / 180) < 1e-9');
    await page.getByRole('button', { name: 'Dismiss the note about the link' }).click();
    await expect.poll(() => page.getByTestId('foreign-robot').count()).toBe(0);
  });
});

test('the play scale of a robot with more play keeps its balls in their bearings', async () => {
  const file = join(folder, 'tripod.toml');
  writeFileSync(file, `kind = "gpr"
name = "Unsymmetric tripod"
limb = [
  { socket_radius_mm = 120, socket_angle_deg = 10 },
  { socket_radius_mm = 80, socket_angle_deg = 140 },
  { socket_radius_mm = 100, socket_angle_deg = 250 },
]
limits = { rod_mm = [200, 420], tilt_deg = 3 }
working = { height_mm = 300 }
`);
  const server = await serve(0, [file]);
  const page = await visit(browser);
  try {
    await load(page, server.address);
    await drawn(page);
    const scale = async () => (await page.getByTestId('play-scale').textContent())!.trim();
    await until('a play scale below 500×', async () => (await scale()) !== '500×');
    const first = Number((await scale()).replace('×', ''));
    const displaced_mm = await page.evaluate(() => {
      const { sockets_m } = window.jointplay.probe.pose!.models[0]!.answer!;
      const nominal = [[120, 10], [80, 140], [100, 250]].map(([r, deg]) => [r! * Math.cos((deg! * Math.PI) / 180), r! * Math.sin((deg! * Math.PI) / 180)]);
      return Math.max(...nominal.map(([x, y], k) => Math.hypot(1000 * sockets_m[k]![0]! - x!, 1000 * sockets_m[k]![1]! - y!)));
    });
    // The play is visible, and less than the drawn gap of the bearings.
    expect(first * displaced_mm).toBeGreaterThan(3);
    expect(first * displaced_mm).toBeLessThanOrEqual(18.5);
    await expect.poll(() => page.getByRole('button', { name: 'Undo' }).isDisabled()).toBe(true);
    // A chosen play scale stays, also after a reload.
    await page.getByTestId('exaggeration').fill('900');
    await until('the chosen one', async () => (await scale()) !== `${first}×`);
    const chosen = await scale();
    await until('the link has it', async () => page.url().includes(`play=${chosen.replace('×', '')}`));
    await reload(page);
    await drawn(page);
    await expect.poll(() => scale()).toBe(chosen);
  } finally {
    await page.context().close();
    await server.stop();
  }
});
