// Updates the 3D scene of the robot to a pose computed by the server.

import { Matrix4, Quaternion, Vector3 } from 'three';
import type { ModelDocument, PlacedDocument, PoseDocument, RobotDocument } from '../api/client';
import type { Shown } from '../lib/document';
import { displayedBall, jointPaths, type Point, type Triple } from '../lib/geometry';
import { jointLabels } from '../lib/joints';
import { small, type LengthUnit } from '../lib/units';
import type { AxisArrow, Label } from './labels';
import { MODEL_COLOURS, SCENE, type Theme } from './palette';
import { RobotModel, SIZES } from './robotModel';
import { finerDecimals, sceneUnits } from './robotSize';
import type { Annotations } from './annotations';

/** A pose with all options of its display. */
export interface RobotPicture {
  robot: RobotDocument;
  pose: PoseDocument;
  /** The model whose platform is displayed. */
  model: string;
  exaggeration: number;
  shown: Shown;
  theme: Theme;
  unit: LengthUnit;
}

/** The result of a model at a pose. */
export function modelResult(pose: PoseDocument, model: string): ModelDocument | undefined {
  return pose.models.find((one) => one.model.virtualization === model);
}

/** Displayed pose of a rigid platform: its in-plane displacement from the base axis is exaggerated. */
interface PlatformPlacement {
  matrix: Matrix4;
  center: Vector3;
  /** Displayed positions of the nominal sockets. */
  sockets: Vector3[];
  /** Transforms a vector in the platform plane to the base frame. */
  toBase: (vector: Point) => Vector3;
}

/** Updates model and annotations to a pose, and returns the labels; axes of frames are added to `axes` instead of the scene if it is given. */
export function updateRobotScene(picture: RobotPicture, body: RobotModel, annotations: Annotations, axes: AxisArrow[] | null = null): Label[] {
  const { robot, pose, exaggeration, shown, theme, unit } = picture;
  const colours = SCENE[theme];
  const models = MODEL_COLOURS[theme];
  const units = sceneUnits(robot.limbs);
  const finer = finerDecimals(robot.limbs);
  const sockets = robot.limbs.map(({ socket_m }) => [socket_m[0]! * units, socket_m[1]! * units] as Point);
  const labels: Label[] = [];
  const result = modelResult(pose, picture.model)?.answer;
  const placement = result ? placementOf(result.pose, result.torsion_rad, sockets, pose.axis_height_m, exaggeration, units) : null;
  const ghost = placementOf(pose.approximate.pose, 0, sockets, pose.axis_height_m, exaggeration, units);
  const displayed = placement ?? ghost;
  // Exactly the displacements of the model, or those of the approximate pose.
  const displacements = sockets.map((socket, k): Vector3 => {
    if (!result) return new Vector3(...(pose.approximate.gaps_m[k] as Triple)).multiplyScalar(units * exaggeration);
    const [x, y] = displayedBall(socket, [result.sockets_m[k]![0]! * units, result.sockets_m[k]![1]! * units], exaggeration);
    return displayed.toBase([x - socket[0], y - socket[1]]);
  });
  const balls = displacements.map((displacement, k) => (displayed.sockets[k] as Vector3).clone().add(displacement));
  // The bearings are just wide enough for the largest displacement.
  const gap = Math.max(...displacements.map((one) => one.length()));
  body.place(balls, displayed.matrix, gap);
  body.platform.visible = placement !== null;
  body.ghost.visible = shown.ghost;
  body.ghost.matrix.copy(ghost.matrix);

  annotations.begin();
  const colour = models[picture.model] ?? colours.ink;
  const rim = (k: number, by: number) => {
    const [x, y] = sockets[k] as Point;
    const radius = Math.hypot(x, y) || 1;
    return (balls[k] as Vector3).clone().add(displayed.toBase([(x / radius) * by, (y / radius) * by]));
  };
  if (placement && result && exaggeration > 1)
    displacements.forEach((displacement, k) => {
      // The side of the bearing that the ball has moved to.
      if (displacement.length() < 0.3) return;
      const radius = RobotModel.raceRadius(gap);
      const along = displacement.clone().normalize();
      const across = new Vector3().setFromMatrixColumn(displayed.matrix, 2).cross(along);
      const arc = Array.from({ length: 13 }, (_, i) => {
        const angle = ((i - 6) / 6) * 0.5;
        return (displayed.sockets[k] as Vector3).clone().addScaledVector(along, radius * Math.cos(angle)).addScaledVector(across, radius * Math.sin(angle));
      });
      annotations.path(arc, 1.1, colours.contact, 8);
    });
  if (placement && result && shown.joints) {
    const jointTexts = jointLabels(robot, picture.model, result.virtual_joints, unit);
    sockets.forEach((socket, k) => {
      const start = placement.sockets[k] as Vector3;
      const moved = result.sockets_m[k] as [number, number];
      const delta: Point = [
        exaggeration * (moved[0] * units - socket[0]),
        exaggeration * (moved[1] * units - socket[1]),
      ];
      const paths = jointPaths(picture.model, socket, delta);
      const inBase = ([x, y]: Point) => start.clone().add(placement.toBase([x, y]));
      rails(picture.model, socket, delta).forEach((rail) => annotations.path(rail.map(inBase), 0.45, colour, 9));
      paths.forEach((path) => annotations.path(path.map(inBase), 1.5, colour));
      annotations.dot(start, 2.6, colour);
      if (shown.labels) labels.push({ position: rim(k, SIZES.rim), text: jointTexts[k] as string, extent: 90, awayFrom: displayed.center, colour: legible(colour, theme), strong: true });
    });
  }
  if (shown.ghost) {
    const grey = models['approximate'] as string;
    for (const line of body.lines) {
      const points = [...line, line[0] as Point].map(([x, y]) => new Vector3(x, y, 0).applyMatrix4(ghost.matrix));
      annotations.path(points, 0.7, colours.ink, 7);
    }
    sockets.forEach((_, k) => {
      const ball = balls[k] as Vector3;
      const to = ghost.sockets[k] as Vector3;
      annotations.arrow(ball, to, 1, grey, 9);
      const gap = new Vector3(...(pose.approximate.gaps_m[k] as Triple)).length();
      if (shown.labels) labels.push({ position: rim(k, SIZES.rim), text: `gap ${small(gap, unit, 1 + finer)}`, extent: 60, awayFrom: displayed.center, colour: legible(grey, theme) });
    });
  }
  if (shown.others) {
    for (const { model, answer } of pose.models) {
      if (!answer || model.virtualization === picture.model) continue;
      const other = placementOf(answer.pose, answer.torsion_rad, sockets, pose.axis_height_m, exaggeration, units);
      const own = models[model.virtualization] as string;
      for (const line of body.lines) annotations.path([...line, line[0] as Point].map(([x, y]) => new Vector3(x, y, 0).applyMatrix4(other.matrix)), 0.8, own, 7);
      const [x, y] = body.lines[0]![0] as Point;
      if (shown.labels) labels.push({ position: new Vector3(x, y, 0).applyMatrix4(other.matrix), text: model.virtualization, extent: 60, awayFrom: other.center, colour: legible(own, theme) });
    }
  }
  const axis = new Vector3(0, 0, pose.axis_height_m * units);
  if (shown.arrows) {
    for (const { model, answer } of pose.models) {
      if (!answer) continue;
      const [x, y] = answer.center_shift_m as [number, number];
      const tip = axis.clone().add(new Vector3(x, y, 0).multiplyScalar(units * exaggeration));
      const own = models[model.virtualization] as string;
      const strong = model.virtualization === picture.model;
      annotations.arrow(axis, tip, strong ? 1.7 : 1.2, own, strong ? 14 : 12);
      if (shown.labels) labels.push({ position: tip, text: `${model.virtualization} ${small(Math.hypot(x, y), unit, 1 + finer)}`, awayFrom: axis, extent: 26, colour: legible(own, theme), strong });
    }
    annotations.dot(axis, 1.8, colours.ink, 15);
  }
  if (shown.frames) {
    const arrow = (from: Vector3, to: Vector3, axis: string) => (axes ? void axes.push({ from, to, colour: axis }) : annotations.arrow(from, to, 0.9, axis, 8));
    frame(arrow, labels, new Vector3(), (vector) => vector, 'b', colours.axes, shown.labels);
    if (placement && result) {
      const basis = columns(result.pose.rotation);
      const toBase = ({ x, y, z }: Vector3) =>
        new Vector3().addScaledVector(basis[0], x).addScaledVector(basis[1], y).addScaledVector(basis[2], z);
      frame(arrow, labels, placement.center, toBase, 'p', colours.axes, shown.labels);
    }
  }
  annotations.end();
  return labels;
}

/** The color of a text: on a light background, a darker shade for contrast. */
export function legible(colour: string, theme: Theme): string {
  if (theme === 'dark') return colour;
  const darker: Record<string, string> = { '#e69f00': '#8a5f00', '#56b4e9': '#1d6f9f', '#cc79a7': '#9b3f73', '#787878': '#5a5a5a' };
  return darker[colour] ?? colour;
}

function placementOf({ origin_m, rotation }: PlacedDocument, torsion_rad: number, sockets: Point[], axis_height_m: number, exaggeration: number, units: number): PlatformPlacement {
  const [ex, ey, ez] = columns(rotation);
  const axis = new Vector3(0, 0, axis_height_m * units);
  const center = new Vector3(...(origin_m as Triple)).multiplyScalar(units).sub(axis).multiplyScalar(exaggeration).add(axis);
  const twist = new Quaternion().setFromAxisAngle(ez, (exaggeration - 1) * torsion_rad);
  for (const axis of [ex, ey]) axis.applyQuaternion(twist);
  const toBase = ([x, y]: Point) => new Vector3().addScaledVector(ex, x).addScaledVector(ey, y);
  const matrix = new Matrix4().makeBasis(ex, ey, ez).setPosition(center);
  return { matrix, center, sockets: sockets.map((socket) => center.clone().add(toBase(socket))), toBase };
}

function columns(rotation: number[][]): [Vector3, Vector3, Vector3] {
  const column = (i: number) => new Vector3(rotation[0]![i], rotation[1]![i], rotation[2]![i]);
  return [column(0), column(1), column(2)];
}

/** Directions of motion of a model's joints as in Figs. 3 and 4 of the paper, from the displayed socket. */
function rails(model: string, nominal: Point, delta: Point): Point[][] {
  const radius = Math.hypot(...nominal) || 1;
  const out: Point = [nominal[0] / radius, nominal[1] / radius];
  const along = (from: number, to: number): Point[] => [
    [out[0] * from, out[1] * from],
    [out[0] * to, out[1] * to],
  ];
  const reach = 30;
  switch (model) {
    case 'radial':
      return [along(-reach, reach)];
    case 'polar': {
      const arc = Array.from({ length: 13 }, (_, i): Point => {
        const angle = ((i - 6) / 6) * (reach / radius);
        const [c, s] = [Math.cos(angle), Math.sin(angle)];
        return [nominal[0] * (c - 1) - nominal[1] * s, nominal[0] * s + nominal[1] * (c - 1)];
      });
      return [along(-reach, reach), arc];
    }
    case 'offset': {
      const far = Math.hypot(...delta);
      const ring = Array.from({ length: 33 }, (_, i): Point => {
        const angle = (2 * Math.PI * i) / 32;
        return [far * Math.cos(angle), far * Math.sin(angle)];
      });
      return far > 0.5 ? [along(0, reach), ring] : [along(0, reach)];
    }
    default:
      return [
        [
          [-reach, 0],
          [reach, 0],
        ],
        [
          [0, -reach],
          [0, reach],
        ],
      ];
  }
}

function frame(
  arrow: (from: Vector3, to: Vector3, colour: string) => void,
  labels: Label[],
  origin: Vector3,
  toBase: (vector: Vector3) => Vector3,
  name: 'b' | 'p',
  colours: [string, string, string],
  labelled: boolean,
): void {
  const names = ['x', 'y', 'z'];
  [new Vector3(1, 0, 0), new Vector3(0, 1, 0), new Vector3(0, 0, 1)].forEach((axis, i) => {
    const colour = colours[i] as string;
    const tip = origin.clone().add(toBase(axis).multiplyScalar(name === 'b' ? 46 : 38));
    arrow(origin, tip, colour);
    if (labelled && name === 'b') labels.push({ position: tip, text: names[i] as string, colour, offset: [6, 0], extent: 46, hides: true });
  });
  if (labelled && name === 'b') labels.push({ position: origin, text: 'O_b', offset: [-8, 10], extent: 46, hides: true });
}
