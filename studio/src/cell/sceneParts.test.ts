import { Group, Mesh, MeshBasicMaterial, Object3D } from 'three';
import { expect, test } from 'vitest';
import { partKey } from '../lib/parts';
import { sceneParts } from './sceneParts';

function frame(name: string, ...children: Object3D[]): Object3D {
  const made = new Object3D();
  made.userData = { name };
  if (children.length > 0) made.add(...children);
  return made;
}
function mesh(name: string, material: string, station?: string): Mesh {
  const made = new Mesh(undefined, new MeshBasicMaterial());
  (made.material as MeshBasicMaterial).name = material;
  made.userData = { name, ...(station === undefined ? {} : { station }) };
  return made;
}

// Bodies, zones, stations and frames share their names.
const link = frame('link', mesh('link', 'arm'), mesh('A', 'arm'));
const platform = frame('platform', mesh('platform', 'robot'), link);
const wafer = frame('A 1', mesh('wafer', 'wafer'));
const base = frame('base', frame('q1', mesh('rod', 'robot')), frame('q2', mesh('rod', 'robot')), frame('q3', mesh('rod', 'robot')), platform, wafer, mesh('base', 'body'), mesh('A 1', 'body', 'A'), mesh('A 1', 'station', 'A'), mesh('A 2', 'station', 'A'), mesh('A 1 1', 'station', 'A 1'), mesh('A 1', 'keep out'), mesh('turning', 'safe'));
const scene = new Group();
scene.add(base);
const bodies = [
  { name: 'platform', attached_to: 'platform', station: null },
  { name: 'A', attached_to: 'link', station: null },
  { name: 'A 1', attached_to: 'base', station: 'A' },
  { name: 'base', attached_to: 'base', station: null },
];

test('meshes of one name show different parts', () => {
  const { meshes, frames, objects } = sceneParts(scene, bodies);
  expect([...meshes.values()].map(partKey)).toEqual(['axis:q1', 'axis:q2', 'axis:q3', 'body:platform', 'link:link', 'body:A', 'wafer:A 1', 'body:base', 'body:A 1', 'slot:1:A', 'slot:2:A', 'slot:1:A 1', 'zone:A 1', 'zone:turning']);
  expect([...frames.keys()]).toEqual(['q1', 'q2', 'q3', 'platform', 'link', 'A 1']);
  expect(objects.get('platform:platform')).toBe(platform);
  expect(objects.get('wafer:A 1')).toBe(wafer);
  expect(objects.get('link:link')).toBe(link);
});

test('an empty scene has no parts', () => {
  expect(sceneParts(new Group(), []).meshes.size).toBe(0);
});
