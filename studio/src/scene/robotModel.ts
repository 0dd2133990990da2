// 3D model of the three-rod robot: flange, guides, rods, balls, platform. Units: mm.

import {
  BufferGeometry,
  CylinderGeometry,
  DoubleSide,
  ExtrudeGeometry,
  Group,
  Mesh,
  MeshStandardMaterial,
  Path,
  Quaternion,
  Shape,
  SphereGeometry,
  TorusGeometry,
  Vector2,
  Vector3,
  type Material,
  type Object3D,
} from 'three';
import { outline, type Point } from '../lib/geometry';
import { disposeGeometries } from './dispose';
import type { SceneColours } from './palette';

/** Dimensions that are not in the robot file, chosen to resemble the robot [mm]. */
export const SIZES = {
  flange: 16,
  housing: 90,
  housingRadius: 26,
  guide: 44,
  guideRadius: 15,
  rod: 6.5,
  ball: 8.5,
  plate: 9,
  rim: 34,
  hole: 21,
  tail: 96,
} as const;

const UP = new Vector3(0, 0, 1);

export interface RobotGeometry {
  /** Intersections of the rod axes with the base plane [mm]. */
  bases: Point[];
  /** Nominal sockets in the platform frame [mm]. */
  sockets: Point[];
}

export class RobotMaterials {
  // Low metalness: metallic materials reflect the environment, and there is none.
  readonly base = new MeshStandardMaterial({ metalness: 0.1, roughness: 0.6 });
  readonly guide = new MeshStandardMaterial({ metalness: 0.15, roughness: 0.5 });
  readonly rod = new MeshStandardMaterial({ metalness: 0.2, roughness: 0.35 });
  readonly ball = new MeshStandardMaterial({ metalness: 0.2, roughness: 0.22 });
  readonly platform = new MeshStandardMaterial({ metalness: 0.05, roughness: 0.5 });
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
    this.rod.color.set(colours.rod);
    this.ball.color.set(colours.ball);
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

/** A cylinder along z, its lower end at z = 0. */
function pillar(radius: number, height: number, segments = 48): CylinderGeometry {
  const geometry = new CylinderGeometry(radius, radius, height, segments);
  geometry.rotateX(Math.PI / 2);
  geometry.translate(0, 0, height / 2);
  return geometry;
}

function plateShape(line: Point[], holes: [Point, number][]): Shape {
  const shape = new Shape(line.map(([x, y]) => new Vector2(x, y)));
  for (const [[x, y], radius] of holes) shape.holes.push(new Path().absarc(x, y, radius, 0, 2 * Math.PI, true));
  return shape;
}

/** Outline and holes of the nominal platform. */
export function platePlan(sockets: Point[]): { line: Point[]; holes: [Point, number][] } {
  const reach = Math.min(...sockets.map(([x, y]) => Math.hypot(x, y)));
  const holes: [Point, number][] = sockets.map((socket) => [socket, SIZES.hole]);
  const middle = Math.max(0, Math.min(32, reach - SIZES.hole - 14));
  if (middle > 4) holes.push([[0, 0], middle]);
  return { line: outline(sockets, SIZES.rim), holes };
}

export class RobotModel {
  readonly group = new Group();
  readonly base = new Group();
  readonly platform = new Group();
  readonly ghost = new Group();
  /** Outlines of the nominal platform, in its plane. */
  readonly lines: Point[][];
  readonly #rods: Mesh[] = [];
  readonly #balls: Mesh[] = [];
  readonly #rings: Mesh[] = [];
  readonly #bases: Point[];

  constructor({ bases, sockets }: RobotGeometry, materials: RobotMaterials) {
    this.#bases = bases;
    const line = outline(bases, SIZES.housingRadius + 8);
    const flange = new ExtrudeGeometry(plateShape(line, []), {
      depth: SIZES.flange,
      bevelThickness: 1.5,
      bevelSize: 1.5,
      bevelSegments: 2,
      curveSegments: 32,
    });
    flange.translate(0, 0, -SIZES.flange - 1.5);
    mesh(flange, materials.base, this.base);
    const housing = new ExtrudeGeometry(plateShape(outline(bases, SIZES.housingRadius - 4), []), {
      depth: SIZES.housing,
      bevelEnabled: false,
    });
    housing.translate(0, 0, -SIZES.flange - SIZES.housing);
    mesh(housing, materials.base, this.base);
    for (const [x, y] of bases) {
      const guide = mesh(pillar(SIZES.guideRadius, SIZES.guide), materials.guide, this.base);
      guide.position.set(x, y, 0);
      const collar = mesh(pillar(SIZES.guideRadius + 6, 8), materials.guide, this.base);
      collar.position.set(x, y, 0);
      const rod = mesh(pillar(SIZES.rod, 1, 32), materials.rod, this.group);
      this.#rods.push(rod);
      this.#balls.push(mesh(new SphereGeometry(SIZES.ball, 40, 24), materials.ball, this.group));
      this.#rings.push(mesh(new TorusGeometry(SIZES.ball + 2.2, 1.9, 16, 48), materials.guide, this.group));
    }
    this.group.add(this.base);

    const plan = platePlan(sockets);
    const bevel = 1.2;
    const plate = new ExtrudeGeometry(plateShape(plan.line, plan.holes), {
      depth: SIZES.plate - 2 * bevel,
      bevelThickness: bevel,
      bevelSize: bevel,
      bevelOffset: -bevel,
      bevelSegments: 2,
      curveSegments: 40,
    });
    plate.translate(0, 0, bevel - SIZES.plate / 2);
    mesh(plate, materials.platform, this.platform);
    this.platform.matrixAutoUpdate = false;
    this.group.add(this.platform);

    const thinPlate = new ExtrudeGeometry(plateShape(plan.line, plan.holes), { depth: 1, bevelEnabled: false, curveSegments: 40 });
    thinPlate.translate(0, 0, -0.5);
    const ghost = new Mesh(thinPlate, materials.ghost);
    ghost.renderOrder = 2;
    this.ghost.add(ghost);
    this.lines = [plan.line, ...plan.holes.map(([center, radius]) => circle(center, radius))];
    this.ghost.matrixAutoUpdate = false;
    this.ghost.visible = false;
    this.group.add(this.ghost);
  }

  /** Replaces a generated part by a mesh of the robot file. */
  setMesh(part: 'base' | 'platform', mesh: Object3D): void {
    disposeGeometries(this[part]);
    this[part].clear();
    this[part].add(mesh);
  }

  /** Moves rods and balls to given ball centres [mm]. */
  place(balls: Vector3[], normal: Vector3): void {
    const rotation = new Quaternion().setFromUnitVectors(UP, normal);
    balls.forEach((ball, k) => {
      const [x, y] = this.#bases[k] as Point;
      const rod = this.#rods[k] as Mesh;
      rod.position.set(x, y, -SIZES.tail);
      rod.scale.set(1, 1, Math.max(ball.z + SIZES.tail, 1));
      (this.#balls[k] as Mesh).position.copy(ball);
      const ring = this.#rings[k] as Mesh;
      ring.position.copy(ball);
      ring.quaternion.copy(rotation);
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
