// 3D model of a mechanism: bars of links, joints by kind, virtual joints. Units: m, as the server sends them.

import { Box3, Group, Matrix4, Mesh, MeshStandardMaterial, Quaternion, Vector3, type BufferGeometry, type Material } from 'three';
import { mergeGeometries } from 'three/examples/jsm/utils/BufferGeometryUtils.js';
import type { MechanismDocument, PlacedDocument, RedundantConstraint } from '../api/client';
import { disposeGeometries, disposeMaterials } from '../scene/dispose';
import type { SceneColours } from '../scene/palette';
import { MechanismShapes, UP } from './mechanismShapes';

/** Mechanisms with more joints have fewer faces in drafts. */
const MOST_FINE = 24;
const SHAPES = new MechanismShapes(1);
const COARSE_SHAPES = new MechanismShapes(0.35);

/** The matrix of a pose. */
export function matrixOf({ origin_m: [x, y, z], rotation: [a, b, c] }: PlacedDocument): Matrix4 {
  return new Matrix4().set(a![0]!, a![1]!, a![2]!, x!, b![0]!, b![1]!, b![2]!, y!, c![0]!, c![1]!, c![2]!, z!, 0, 0, 0, 1);
}

/** Materials of a scene. */
export class MechanismMaterials {
  readonly base = new MeshStandardMaterial({ metalness: 0.55, roughness: 0.45 });
  readonly links = [new MeshStandardMaterial({ metalness: 0.45, roughness: 0.38 }), new MeshStandardMaterial({ metalness: 0.5, roughness: 0.34 })];
  readonly joint = new MeshStandardMaterial({ metalness: 0.8, roughness: 0.26 });
  readonly actuated = new MeshStandardMaterial({ metalness: 0.35, roughness: 0.36 });
  readonly virtual = new MeshStandardMaterial({ metalness: 0, roughness: 0.5 });
  readonly selected = new MeshStandardMaterial({ metalness: 0, roughness: 0.5, emissive: 0x5a3d00 });
  readonly load = new MeshStandardMaterial({ metalness: 0, roughness: 0.5 });

  paint(colours: SceneColours): void {
    this.base.color.setHex(colours.base);
    this.links[0]!.color.setHex(colours.platform);
    this.links[1]!.color.setHex(colours.rod);
    this.joint.color.setHex(colours.guide);
    this.actuated.color.setHex(colours.actuated);
    this.virtual.color.setHex(colours.virtual);
    this.selected.color.setHex(colours.selected);
    this.load.color.setHex(colours.load);
  }

  /** Makes all parts translucent, in one colour: the picture of a reference. */
  makeGhost(colour: number): void {
    for (const material of this.#all) {
      Object.assign(material, { transparent: true, opacity: 0.3, depthWrite: false });
      material.color.setHex(colour);
    }
  }

  get #all(): MeshStandardMaterial[] {
    return [this.base, ...this.links, this.joint, this.actuated, this.virtual, this.selected, this.load];
  }

  dispose(): void {
    disposeMaterials(this.#all);
  }
}

/** What a part draws. */
export interface PartOf {
  kind: 'link' | 'joint' | 'virtual';
  name: string;
}

export class MechanismModel {
  readonly group = new Group();
  readonly #links: Group[];
  readonly #joints: Group[];
  readonly #loads = new Group();
  readonly #materials: MechanismMaterials;
  readonly #document: MechanismDocument;
  /** Shapes of the parts that are not drawn: those with fewer faces, or, while these are drawn, the others. */
  readonly #undrawn = new Map<Mesh, BufferGeometry>();
  #isCoarse = false;

  constructor(document: MechanismDocument, materials: MechanismMaterials) {
    this.#document = document;
    this.#materials = materials;
    const { bar_radius_m: bar, joint_radius_m: jointRadius } = document;
    this.#links = document.links.map(({ name, bars }, i) => {
      const group = new Group();
      // Coaxial bars of neighbouring links have different radii.
      const radius = i === 0 ? 0.7 * bar : i % 2 === 0 ? bar : 0.88 * bar;
      const material = i === 0 ? materials.base : materials.links[i % 2]!;
      const ends = distinct(bars.flatMap(({ from_m, to_m }) => [from_m, to_m]));
      const drawn = (shapes: MechanismShapes) => [
        ...bars.map(({ from_m, to_m }) => shapes.rod(new Vector3(...from_m), new Vector3(...to_m), radius)),
        ...ends.map(([x, y, z]) => shapes.ball(radius).translate(x!, y!, z!)),
      ];
      if (bars.length > 0) group.add(this.#part({ kind: 'link', name }, drawn, material));
      group.matrixAutoUpdate = false;
      this.group.add(group);
      return group;
    });
    this.#joints = document.joints.map(({ name, kind, links, frames, actuated }) => {
      const group = new Group();
      const material = actuated ? materials.actuated : materials.joint;
      group.add(this.#part({ kind: 'joint', name }, (shapes) => shapes.joint(kind, jointRadius), material));
      group.applyMatrix4(matrixOf(frames[0]!));
      this.#links[links[0]!]!.add(group);
      return group;
    });
    for (const { name, joint, link, motion, direction } of document.virtual_joints) {
      const of = document.joints[joint]!;
      const group = new Group();
      const drawn = (shapes: MechanismShapes) => (motion === 'slide' ? shapes.slideArrow(jointRadius) : shapes.turnArrow(jointRadius));
      group.add(this.#part({ kind: 'virtual', name }, drawn, materials.virtual));
      const side = of.links[0] === link ? 0 : 1;
      group.position.setFromMatrixPosition(matrixOf(of.frames[side]!));
      group.quaternion.setFromUnitVectors(new Vector3(0, 0, 1), new Vector3(...direction).normalize());
      this.#links[link]!.add(group);
    }
    this.group.add(this.#loads);
  }

  dispose(): void {
    this.drawCoarsely(false);
    disposeGeometries(this.group);
    for (const geometry of this.#undrawn.values()) geometry.dispose();
  }

  /** A mesh of several shapes: each mesh takes time in every picture, whatever its size. */
  #part(of: PartOf, drawn: (shapes: MechanismShapes) => BufferGeometry[], material: Material): Mesh {
    const mesh = new Mesh(mergeGeometries(drawn(SHAPES))!, material);
    mesh.userData = { part: of, material };
    mesh.castShadow = true;
    if (this.#document.joints.length > MOST_FINE) this.#undrawn.set(mesh, mergeGeometries(drawn(COARSE_SHAPES))!);
    return mesh;
  }

  /** Draws many parts with fewer faces, as pictures of a moving mechanism without a graphics card need it. */
  drawCoarsely(isCoarse: boolean): void {
    if (isCoarse === this.#isCoarse) return;
    this.#isCoarse = isCoarse;
    for (const [mesh, geometry] of this.#undrawn) {
      this.#undrawn.set(mesh, mesh.geometry);
      mesh.geometry = geometry;
    }
  }

  /** Moves the links. */
  place(poses: readonly PlacedDocument[]): void {
    this.#links.forEach((group, i) => {
      const pose = poses[i];
      if (!pose) return;
      group.matrix.copy(matrixOf(pose));
      group.matrixWorldNeedsUpdate = true;
    });
  }

  /** Moves the links between two sets of poses. */
  placeBetween(from: readonly PlacedDocument[], to: readonly PlacedDocument[], share: number): void {
    const [a, b, scale] = [new Quaternion(), new Quaternion(), new Vector3()];
    const [p, q] = [new Vector3(), new Vector3()];
    this.#links.forEach((group, i) => {
      matrixOf(from[i]!).decompose(p, a, scale);
      matrixOf(to[i]!).decompose(q, b, scale);
      group.matrix.compose(p.lerp(q, share), a.slerp(b, share), scale.set(1, 1, 1));
      group.matrixWorldNeedsUpdate = true;
    });
  }

  /** Highlights parts. */
  highlight(selected: (part: PartOf) => boolean): void {
    this.group.traverse((object) => {
      if (!(object instanceof Mesh) || !object.userData.part) return;
      const own = object.userData as { part: PartOf; material: Material };
      object.material = selected(own.part) ? this.#materials.selected : own.material;
    });
  }

  /** Draws the forces and moments of a redundant constraint; `null` draws none. */
  showLoads(constraint: RedundantConstraint | null): void {
    disposeGeometries(this.#loads);
    this.#loads.clear();
    const { joint_radius_m: radius, size_m } = this.#document;
    for (const { place_mm, force_n, moment_nmm } of constraint?.remove_any_one_of ?? []) {
      const place = new Vector3(...place_mm).divideScalar(1000);
      const force = new Vector3(...force_n);
      if (force.length() > 1e-6) this.#arrow(place, force.multiplyScalar(0.35 * size_m), radius, 1);
      else if (new Vector3(...moment_nmm).length() > 0) this.#arrow(place, new Vector3(...moment_nmm).setLength(0.35 * size_m), radius, 2);
    }
  }

  #arrow(from: Vector3, vector: Vector3, radius: number, heads: number): void {
    const length = vector.length();
    const direction = vector.clone().normalize();
    const head = Math.min(2 * radius, 0.5 * length);
    this.#loads.add(new Mesh(SHAPES.rod(from, from.clone().addScaledVector(direction, length - head), 0.28 * radius), this.#materials.load));
    for (let k = 0; k < heads; k++) {
      const cone = new Mesh(SHAPES.cone(0.75 * radius, head), this.#materials.load);
      cone.position.copy(from).addScaledVector(direction, length - head / 2 - k * head);
      cone.quaternion.setFromUnitVectors(UP, direction);
      this.#loads.add(cone);
    }
  }

  /** The box around all parts, in the scene. */
  get box(): Box3 {
    this.group.updateMatrixWorld(true);
    return new Box3().setFromObject(this.group);
  }

  /** Whether the mechanism has a part of this kind and name. */
  hasPart({ kind, name }: PartOf): boolean {
    const { links, joints, virtual_joints } = this.#document;
    const parts: readonly { name: string }[] = kind === 'link' ? links : kind === 'joint' ? joints : virtual_joints;
    return parts.some((one) => one.name === name);
  }

  /** The moving link of a part; `null` for the base. */
  movingLink({ kind, name }: PartOf): string | null {
    const { links, joints, virtual_joints } = this.#document;
    const at = kind === 'link' ? [links.findIndex((one) => one.name === name)] : (joints[kind === 'joint' ? joints.findIndex((one) => one.name === name) : virtual_joints.find((one) => one.name === name)!.joint]?.links ?? []);
    return links[at.find((k) => k > 0) ?? 0] === links[0] ? null : links[at.find((k) => k > 0)!]!.name;
  }

  /** A position in the scene, in the frame of a link [m]. */
  inLink(link: string, position: Vector3): Vector3 {
    return this.#group(link).worldToLocal(position.clone());
  }

  /** A point of a link [m], in the scene. */
  ofLink(link: string, point: Vector3): Vector3 {
    return this.#group(link).localToWorld(point.clone());
  }

  #group(link: string): Group {
    this.group.updateMatrixWorld(true);
    return this.#links[this.#document.links.findIndex(({ name }) => name === link)] ?? this.group;
  }

  /** Origins of the links by name, in the scene. */
  linkOrigins(): { name: string; position: Vector3 }[] {
    this.group.updateMatrixWorld(true);
    return this.#document.links.map(({ name }, i) => ({ name, position: this.#links[i]!.getWorldPosition(new Vector3()) }));
  }

  /** Ends of all bars, in the scene. */
  barEnds(): Vector3[][] {
    this.group.updateMatrixWorld(true);
    return this.#document.links.flatMap(({ bars }, i) => bars.map(({ from_m, to_m }) => [from_m, to_m].map((end) => this.#links[i]!.localToWorld(new Vector3(...(end as [number, number, number]))))));
  }

  /** Positions of the joints by name, in the scene. */
  jointPositions(): { name: string; actuated: boolean; position: Vector3 }[] {
    this.group.updateMatrixWorld(true);
    return this.#document.joints.map(({ name, actuated }, i) => ({ name, actuated, position: this.#joints[i]!.getWorldPosition(new Vector3()) }));
  }
}

function distinct(points: readonly number[][]): number[][] {
  const found = new Map(points.map((point) => [point.join(), point]));
  return [...found.values()];
}
