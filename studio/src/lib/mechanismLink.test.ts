import { describe, expect, test } from 'vitest';
import { fromMechanismHash, packText, toMechanismHash, unpackText, type MechanismLink } from './mechanismLink';

const links: MechanismLink[] = [
  { name: 'bennett', packed: null, parameters: {}, coordinates: [0.1 + 0.2, -Math.PI / 3, 1e-17], play: 1, tab: 'tree', selected: null, camera: null },
  { name: 'Kurbel & Süd=1#2.toml', packed: 'abc-_9', parameters: { offset: -0.25, crank: 1e-9 }, coordinates: null, play: 250, tab: 'text', selected: { kind: 'joint', name: 'q=1 & more' }, camera: { eye: [1.5, -2.25, 3], target: [0, 0.125, 0.5] } },
];

describe('a link restores the view it was created from', () => {
  for (const link of links)
    test(link.name, () => expect(fromMechanismHash(toMechanismHash(link))).toEqual(link));
});

test('invalid parts have their defaults', () => {
  const nothing = { name: 'a', packed: null, parameters: {}, coordinates: null, play: 1, tab: 'tree', selected: null, camera: null };
  for (const bad of ['at=1,x', 'at=', 'play=0', 'play=1e999', 'tab=none', 'selected=wheel:b', 'selected=', 'view=1,2,3,1,2,3', 'text=a b', `text=${'a'.repeat(20_001)}`, 'parameters=a', 'parameters=a:b', '=', '&&'])
    expect(fromMechanismHash(`#mechanism=a&${bad}`), bad).toEqual(nothing);
  expect(fromMechanismHash('#cell=a')).toBeNull();
});

test('texts are packed and unpacked, up to a limit', async () => {
  const text = 'kind = "mechanism"\n# Länge ≈ 3 µm\n'.repeat(40);
  const packed = (await packText(text))!;
  expect(packed).toMatch(/^[\w-]+$/);
  expect(packed.length).toBeLessThan(text.length / 4);
  expect(await unpackText(packed, 10_000)).toBe(text);
  await expect(unpackText(packed, 100)).rejects.toThrow('too long');
  await expect(unpackText(packed.slice(0, 8), 10_000)).rejects.toThrow();
  const noise = Array.from({ length: 30_000 }, (_, k) => String.fromCharCode(33 + ((k * k * 7919 + k * 104_729) % 9311) % 90)).join('');
  const packedNoise = await packText(noise);
  if (packedNoise !== null) expect(packedNoise.length).toBeLessThanOrEqual(20_000);
});
