// 3D model of the three-rod robot: base with actuators, guides, rods, balls, bearings, platform. Units: those of the scene, see `robotSize.ts`.
//
// All parts are rigid at every play scale: rods with their guides are displaced against the platform, and bearings are larger.

import {
  Box3,
  BufferGeometry,
  CylinderGeometry,
  DoubleSide,
  ExtrudeGeometry,
  Group,
  LatheGeometry,
  Mesh,
  MeshStandardMaterial,
  Path,
  Shape,
  ShapeGeometry,
  SphereGeometry,
  Vector2,
  Vector3,
  type Material,
  type Matrix4,
  type Object3D,
} from 'three';
import { cutPlate, outline, type Point } from '../lib/geometry';
import { disposeGeometries } from './dispose';
import { LARGEST_GAP } from '../lib/playScale';
import type { SceneColours } from './palette';

/** Dimensions that are not in the robot file, chosen to resemble the robot. */
export const SIZES = {
  flange: 16,
  housing: 90,
  housingRadius: 26,
  guide: 44,
  guideRadius: 15,
  motor: 62,
  motorRadius: 21,
  rod: 6.5,
  neck: 4.4,
  ball: 8.5,
  plate: 9,
  rim: 34,
  hole: 21,
  tail: 96,
} as const;

/** Thickness of the race of a bearing, least and largest gap around its ball. */
const BEARING = { wall: 3.2, gap: { min: 0.25, max: LARGEST_GAP }, step: 0.25 } as const;

export interface RobotGeometry {
  /** Intersections of the rod axes with the base plane. */
  bases: Point[];
  /** Nominal sockets in the platform frame. */
  sockets: Point[];
}

export class RobotMaterials {
  readonly base = new MeshStandardMaterial({ metalness: 0.55, roughness: 0.46 });
  readonly guide = new MeshStandardMaterial({ metalness: 0.8, roughness: 0.38 });
  readonly motor = new MeshStandardMaterial({ metalness: 0.35, roughness: 0.5 });
  readonly rod = new MeshStandardMaterial({ metalness: 0.95, roughness: 0.2 });
  readonly ball = new MeshStandardMaterial({ metalness: 0.95, roughness: 0.1 });
  readonly race = new MeshStandardMaterial({ metalness: 0.75, roughness: 0.3, side: DoubleSide });
  readonly section = new MeshStandardMaterial({ metalness: 0, roughness: 0.8, side: DoubleSide });
  readonly platform = new MeshStandardMaterial({ metalness: 0.35, roughness: 0.42 });
  readonly ghost = new MeshStandardMaterial({
    transparent: true,
    opacity: 0.28,
    roughness: 0.9,
    depthWrite: false,
    side: DoubleSide,
  });

  paint(colours: SceneColours): void {
    this.base.color.set(colours.base);
    this.guide.color.set(colours.guide);
    this.motor.color.set(colours.motor);
    this.rod.color.set(colours.rod);
    this.ball.color.set(colours.ball);
    this.race.color.set(colours.race);
    this.section.color.set(colours.section);
    this.platform.color.set(colours.platform);
    this.ghost.color.set(colours.ghost);
  }
}

function mesh(geometry: BufferGeometry, material: Material, parent: Object3D): Mesh {
  const made = new Mesh(geometry, material);
  made.castShadow = true;
  made.receiveShadow = true;
  parent.add(made);
  return made;
}

/** A body of revolution about z with chamfered edges, its lower end at z = 0. */
function turned(radius: number, height: number, chamfer = 1.2, segments = 36): BufferGeometry {
  const c = Math.min(chamfer, 0.4 * radius, 0.4 * height);
  const profile = [[0, 0], [radius - c, 0], [radius, c], [radius, height - c], [radius - c, height], [0, height]];
  // Doubled points keep edges sharp between the smooth surfaces.
  const points = profile.flatMap(([r, z]) => [new Vector2(r, z), new Vector2(r, z)]);
  return new LatheGeometry(points, segments).rotateX(Math.PI / 2);
}

function plateShape(line: Point[], holes: [Point, number][]): Shape {
  const shape = new Shape(line.map(([x, y]) => new Vector2(x, y)));
  for (const [[x, y], radius] of holes) shape.holes.push(new Path().absarc(x, y, radius, 0, 2 * Math.PI, true));
  return shape;
}

function plate(shape: Shape, height: number, bevel: number): BufferGeometry {
  const made = new ExtrudeGeometry(shape, { depth: height - 2 * bevel, bevelThickness: bevel, bevelSize: bevel, bevelOffset: -bevel, bevelSegments: 2, curveSegments: 40 });
  return made.translate(0, 0, bevel);
}

/** Radius of the hole in the middle of the platform; 0 without one. */
function middleHole(sockets: Point[]): number {
  const reach = Math.min(...sockets.map(([x, y]) => Math.hypot(x, y)));
  const radius = Math.max(0, Math.min(32, reach - SIZES.rim - 16));
  return radius > 4 ? radius : 0;
}

/** The race of a spherical bearing, open in a sector; the gap is that around the ball. */
function race(gap: number, open: { from: number; to: number }): { ring: BufferGeometry; sections: BufferGeometry[] } {
  const inner = SIZES.ball + gap;
  const outer = inner + BEARING.wall;
  // The race encloses the ball up to this angle above and below its equator.
  const limit = 0.72;
  const arc = Array.from({ length: 11 }, (_, i) => {
    const angle = limit - (2 * limit * i) / 10;
    return new Vector2(inner * Math.cos(angle), inner * Math.sin(angle));
  });
  const height = Math.max(inner * Math.sin(limit), SIZES.plate / 2 + 0.6);
  const corners = [[outer - 0.8, -height], [outer, 0.8 - height], [outer, height - 0.8], [outer - 0.8, height], [arc[0]!.x, height]] as const;
  const profile = [...arc, new Vector2(arc[10]!.x, -height), ...corners.map(([r, z]) => new Vector2(r, z)), arc[0]!.clone()];
  const angle = 2 * Math.PI - (open.to - open.from);
  const doubled = profile.flatMap((point, i) => (i > 0 && i < 10 ? [point] : [point, point]));
  const ring = new LatheGeometry(doubled, 44, 0, angle).rotateX(Math.PI / 2).rotateZ(Math.PI / 2 + open.to);
  const section = (at: number) => new ShapeGeometry(new Shape(profile)).rotateX(Math.PI / 2).rotateZ(at);
  return { ring, sections: [section(open.from), section(open.to)] };
}

export class RobotModel {
  readonly group = new Group();
  readonly base = new Group();
  readonly platform = new Group();
  readonly ghost = new Group();
  /** Outlines of the nominal platform, in its plane. */
  readonly lines: Point[][];
  readonly #limbs: { guides: Group; rod: Mesh; neck: Mesh; ball: Mesh }[] = [];
  readonly #sockets: Point[];
  readonly #materials: RobotMaterials;
  #gap = -1;
  #generatedPlatform = true;

  constructor({ bases, sockets }: RobotGeometry, materials: RobotMaterials) {
    this.#sockets = sockets;
    this.#materials = materials;
    const flange = plate(plateShape(outline(bases, SIZES.housingRadius + 8, 16), []), SIZES.flange, 2);
    mesh(flange.translate(0, 0, -SIZES.flange), materials.base, this.base);
    const foot = plate(plateShape(outline(bases, SIZES.housingRadius + 4, 16), []), 10, 2);
    mesh(foot.translate(0, 0, -SIZES.flange - SIZES.housing), materials.base, this.base);
    for (const [x, y] of bases) {
      // The actuator moves with its rod when play is exaggerated.
      const guides = new Group();
      mesh(turned(SIZES.motorRadius, SIZES.housing - 10), materials.motor, guides).position.z = -SIZES.flange - SIZES.housing + 10;
      mesh(turned(SIZES.motorRadius + 1.6, 7), materials.guide, guides).position.z = -SIZES.flange - 12;
      mesh(turned(SIZES.guideRadius + 6, 8), materials.guide, guides);
      mesh(turned(SIZES.guideRadius, SIZES.guide, 2.4), materials.guide, guides);
      mesh(turned(SIZES.rod + 3.4, 4, 1), materials.motor, guides).position.z = SIZES.guide - 1;
      guides.position.set(x, y, 0);
      this.base.add(guides);
      const rod = mesh(new CylinderGeometry(SIZES.rod, SIZES.rod, 1, 32).rotateX(Math.PI / 2).translate(0, 0, 0.5), materials.rod, this.group);
      const neck = mesh(new CylinderGeometry(SIZES.neck, SIZES.rod, 16, 32).rotateX(Math.PI / 2).translate(0, 0, -8), materials.rod, this.group);
      const ball = mesh(new SphereGeometry(SIZES.ball, 36, 24), materials.ball, this.group);
      this.#limbs.push({ guides, rod, neck, ball });
    }
    const column = outline(bases.map(([x, y]) => [0.35 * x, 0.35 * y]), 12, 16);
    mesh(new ExtrudeGeometry(plateShape(column, []), { depth: SIZES.housing - 10, bevelEnabled: false }), materials.base, this.base).position.z = -SIZES.flange - SIZES.housing + 10;
    this.group.add(this.base);
    this.platform.matrixAutoUpdate = false;
    this.group.add(this.platform);
    this.#fitBearings(BEARING.gap.min);

    const holes: [Point, number][] = sockets.map((socket) => [socket, SIZES.ball + BEARING.wall]);
    const middle = middleHole(sockets);
    if (middle > 0) holes.push([[0, 0], middle]);
    const line = outline(sockets, SIZES.rim);
    const thinPlate = new ExtrudeGeometry(plateShape(line, holes), { depth: 1, bevelEnabled: false, curveSegments: 40 });
    thinPlate.translate(0, 0, -0.5);
    const ghost = new Mesh(thinPlate, materials.ghost);
    ghost.renderOrder = 2;
    this.ghost.add(ghost);
    this.lines = [line, ...holes.map(([center, radius]) => circle(center, radius))];
    this.ghost.matrixAutoUpdate = false;
    this.ghost.visible = false;
    this.group.add(this.ghost);
  }

  /** Points of the outline of the platform in the base frame. */
  corners(): Vector3[] {
    return this.lines[0]!.map(([x, y]) => new Vector3(x, y, 0).applyMatrix4(this.platform.matrix));
  }

  /** Points of the convex parts that labels do not cover: platform, rods. */
  silhouettes(): Vector3[][] {
    const platform = this.platform.visible ? this.#platformPoints() : this.ghost.visible ? this.lines[0]!.map(([x, y]) => new Vector3(x, y, 0).applyMatrix4(this.ghost.matrix)) : [];
    const rods = this.#limbs.map(({ ball, rod }) => {
      const ends = [rod.position.z, ball.position.z];
      return [-1, 1].flatMap((x) => [-1, 1].flatMap((y) => ends.map((z) => new Vector3(ball.position.x + x * SIZES.rod, ball.position.y + y * SIZES.rod, Math.max(z, 0)))));
    });
    return [platform, ...rods];
  }

  /** Points of the surface of the platform whose convex hull contains it. */
  #platformPoints(): Vector3[] {
    const half = SIZES.plate / 2 + 1;
    if (this.#generatedPlatform) return this.lines[0]!.flatMap(([x, y]) => [half, -half].map((z) => new Vector3(x, y, z).applyMatrix4(this.platform.matrix)));
    const { min, max } = new Box3().setFromObject(this.platform);
    return [min.x, max.x].flatMap((x) => [min.y, max.y].flatMap((y) => [min.z, max.z].map((z) => new Vector3(x, y, z))));
  }

  /** Replaces a generated part by a mesh of the robot file. */
  setMesh(part: 'base' | 'platform', mesh: Object3D): void {
    disposeGeometries(this[part]);
    this[part].clear();
    this[part].add(mesh);
    if (part === 'platform') this.#generatedPlatform = false;
  }

  /** Radius of the displayed race of a bearing for a displayed gap. */
  static raceRadius(gap: number): number {
    return SIZES.ball + Math.min(Math.max(gap, BEARING.gap.min), BEARING.gap.max);
  }

  /** Builds platform and bearings for a gap around the balls. */
  #fitBearings(gap: number): void {
    if (!this.#generatedPlatform) return;
    const rounded = Math.ceil(Math.min(Math.max(gap, BEARING.gap.min), BEARING.gap.max) / BEARING.step) * BEARING.step;
    if (rounded === this.#gap) return;
    this.#gap = rounded;
    disposeGeometries(this.platform);
    this.platform.clear();
    const hole = SIZES.ball + rounded + BEARING.wall;
    const { line, holes, cuts } = cutPlate(this.#sockets, SIZES.rim, hole);
    const middle = middleHole(this.#sockets);
    const all: [Point, number][] = [...holes.map((point): [Point, number] => [point, hole]), ...(middle > 0 ? [[[0, 0], middle] as [Point, number]] : [])];
    mesh(plate(plateShape(line, all), SIZES.plate, 1.1).translate(0, 0, -SIZES.plate / 2), this.#materials.platform, this.platform);
    this.#sockets.forEach(([x, y], k) => {
      const { ring, sections } = race(rounded, cuts[k]!);
      mesh(ring.translate(x, y, 0), this.#materials.race, this.platform);
      for (const section of sections) mesh(section.translate(x, y, 0), this.#materials.section, this.platform);
    });
  }

  /** Moves rods and balls to ball centres, and the platform to its pose; the bearings have a gap around the balls. */
  place(balls: Vector3[], platform: Matrix4, gap: number): void {
    this.#fitBearings(gap);
    this.platform.matrix.copy(platform);
    this.platform.matrixWorldNeedsUpdate = true;
    balls.forEach((ball, k) => {
      const { guides, rod, neck, ball: sphere } = this.#limbs[k]!;
      guides.position.set(ball.x, ball.y, 0);
      const end = ball.z - SIZES.ball - 12;
      rod.position.set(ball.x, ball.y, -SIZES.tail);
      rod.scale.set(1, 1, Math.max(end + SIZES.tail, 1));
      neck.position.set(ball.x, ball.y, end + 16);
      sphere.position.copy(ball);
    });
  }

  dispose(): void {
    disposeGeometries(this.group);
  }
}

function circle([x, y]: Point, radius: number): Point[] {
  return Array.from({ length: 48 }, (_, i) => {
    const angle = (2 * Math.PI * i) / 48;
    return [x + radius * Math.cos(angle), y + radius * Math.sin(angle)];
  });
}
