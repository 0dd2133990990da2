// The parts that the objects of the 3D scene of a cell show, by their places in it: in the base frame, first those of the rods, then that of the platform with the links of the arms, then those of the wafers; bodies, slots and zones are meshes.

import { Mesh, Vector3, type BufferGeometry, type Material, type Object3D } from 'three';
import type { CellParts, Part, PartKind } from '../lib/parts';
import { partKey } from '../lib/parts';
import type { CellMaterial } from '../scene/cellMaterials';

export interface SceneParts {
  /** The part that each mesh shows. */
  meshes: Map<Mesh, Part>;
  /** Moving frames, by the names with which the server sends their poses. */
  frames: Map<string, Object3D>;
  /** The object at the origin of each part, by its key. */
  objects: Map<string, Object3D>;
}

/** Kinds of the moving frames in the base frame, in their order; all following ones are those of wafers. */
const FRAMES: readonly PartKind[] = ['axis', 'axis', 'axis', 'platform'];

const nameOf = ({ name, userData }: Object3D): string => (userData as { name?: string }).name ?? name;

/** The parts of a scene as the server sends it, with its materials; shapes in place of missing bodies show their frame. */
export function sceneParts(scene: Object3D, bodies: CellParts['bodies']): SceneParts {
  const found: SceneParts = { meshes: new Map(), frames: new Map(), objects: new Map() };
  const isBody = new Set(bodies.map(({ name, attached_to, station }) => (station === null ? JSON.stringify([attached_to, name]) : '')));
  const slots = new Map<string, number>();
  const add = (mesh: Mesh, part: Part) => {
    found.meshes.set(mesh, part);
    const key = partKey(part);
    if (!found.objects.has(key)) found.objects.set(key, mesh);
  };
  const addFrame = (frame: Object3D, part: Part) => {
    found.frames.set(part.name, frame);
    found.objects.set(partKey(part), frame);
    for (const child of frame.children)
      if (!(child instanceof Mesh)) addFrame(child, { kind: 'link', name: nameOf(child) });
      else if (isBody.has(JSON.stringify([part.name, nameOf(child)]))) add(child, { kind: 'body', name: nameOf(child) });
      else add(child, part);
  };
  const addStationary = (mesh: Mesh) => {
    const material = (mesh.material as Material).name as CellMaterial;
    if (material === 'station') {
      const { station = '' } = mesh.userData as { station?: string };
      const slot = (slots.get(station) ?? 0) + 1;
      slots.set(station, slot);
      add(mesh, { kind: 'slot', name: station, slot });
    } else add(mesh, { kind: material === 'keep out' || material === 'safe' ? 'zone' : 'body', name: nameOf(mesh) });
  };
  let frames = 0;
  for (const object of scene.children[0]?.children ?? [])
    if (object instanceof Mesh) addStationary(object);
    else addFrame(object, { kind: FRAMES[frames++] ?? 'wafer', name: nameOf(object) });
  return found;
}

/** Corners of the boxes around the visible meshes of an object, in the scene. */
export function boxCorners(object: Object3D): Vector3[][] {
  const found: Vector3[][] = [];
  object.traverse((mesh) => {
    if (!(mesh instanceof Mesh) || !mesh.visible) return;
    const geometry = mesh.geometry as BufferGeometry;
    if (!geometry.boundingBox) geometry.computeBoundingBox();
    const { min, max } = geometry.boundingBox!;
    found.push([min.x, max.x].flatMap((x) => [min.y, max.y].flatMap((y) => [min.z, max.z].map((z) => mesh.localToWorld(new Vector3(x, y, z))))));
  });
  return found;
}
