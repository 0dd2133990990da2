// One answer of the server, drawn.

import { Matrix4, Vector3 } from 'three';
import type { ModelDocument, PoseDocument, RobotDocument } from '../api/client';
import type { Shown } from '../lib/document';
import { jointPaths, planeMap, seat, type Point, type Triple } from '../lib/geometry';
import { jointLabels } from '../lib/joints';
import { small, type LengthUnit } from '../lib/units';
import type { Label } from './labels';
import { MODEL_COLOURS, SCENE, type Theme } from './palette';
import { SIZES, type RobotModel } from './robotModel';
import type { Annotations } from './annotations';

export interface Picture {
  robot: RobotDocument;
  pose: PoseDocument;
  /** The model whose platform is drawn. */
  model: string;
  exaggeration: number;
  shown: Shown;
  theme: Theme;
  unit: LengthUnit;
}

const MM = 1000;

export function drawn(pose: PoseDocument, model: string): ModelDocument | undefined {
  return pose.models.find((one) => one.model.virtualization === model);
}

/** Where the platform of a model is drawn: its plane as a matrix, its centre, its normal. */
interface Placed {
  matrix: Matrix4;
  center: Vector3;
  normal: Vector3;
  seats: Vector3[];
  /** Turns a way in the platform plane into one in the base frame. */
  turn: (way: Point) => Vector3;
}

export function draw(picture: Picture, body: RobotModel, annotations: Annotations): Label[] {
  const { robot, pose, exaggeration, shown, theme, unit } = picture;
  const colours = SCENE[theme];
  const models = MODEL_COLOURS[theme];
  const sockets = robot.limbs.map(({ socket_m }) => [socket_m[0]! * MM, socket_m[1]! * MM] as Point);
  const balls = pose.balls_m.map((ball) => new Vector3(...(ball as Triple)).multiplyScalar(MM));
  const labels: Label[] = [];
  const found = drawn(pose, picture.model)?.answer;
  const placed = found ? place(found.pose.origin_m, found.pose.rotation, sockets, balls, exaggeration) : null;
  const ghost = place(pose.approximate.pose.origin_m, pose.approximate.pose.rotation, sockets, balls, exaggeration);
  const shape = placed ?? ghost;
  body.place(balls, shape.normal);
  body.platform.matrix.copy(shape.matrix);
  body.platform.visible = placed !== null;
  body.ghost.visible = shown.ghost;
  body.ghost.matrix.copy(ghost.matrix);

  annotations.begin();
  const colour = models[picture.model] ?? colours.ink;
  const rim = (k: number, by: number) => {
    const [x, y] = sockets[k] as Point;
    const far = Math.hypot(x, y) || 1;
    return (balls[k] as Vector3).clone().add(shape.turn([(x / far) * by, (y / far) * by]));
  };
  if (placed && found && shown.joints) {
    const beside = jointLabels(robot, picture.model, found.virtual_joints, unit);
    sockets.forEach((socket, k) => {
      const start = placed.seats[k] as Vector3;
      const moved = found.sockets_m[k] as [number, number];
      const delta: Point = [
        exaggeration * (moved[0] * MM - socket[0]),
        exaggeration * (moved[1] * MM - socket[1]),
      ];
      const paths = jointPaths(picture.model, socket, delta);
      const inBase = ([x, y]: Point) => start.clone().add(placed.turn([x, y]));
      rails(picture.model, socket, delta).forEach((rail) => annotations.path(rail.map(inBase), 0.45, colour, 9));
      paths.forEach((path) => annotations.path(path.map(inBase), 1.5, colour));
      annotations.dot(start, 2.6, colour);
      if (shown.labels) labels.push({ at: rim(k, SIZES.rim), text: beside[k] as string, awayFrom: shape.center, colour: legible(colour, theme), strong: true });
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
      const to = ghost.seats[k] as Vector3;
      annotations.arrow(ball, to, 1, grey, 9);
      const gap = new Vector3(...(pose.approximate.gaps_m[k] as Triple)).length();
      if (shown.labels) labels.push({ at: rim(k, SIZES.rim), text: `gap ${small(gap, unit)}`, awayFrom: shape.center, colour: legible(grey, theme) });
    });
  }
  const axis = new Vector3(0, 0, pose.axis_height_m * MM);
  if (shown.arrows) {
    for (const { model, answer } of pose.models) {
      if (!answer) continue;
      const [x, y] = answer.center_shift_m as [number, number];
      const tip = axis.clone().add(new Vector3(x, y, 0).multiplyScalar(MM * exaggeration));
      const own = models[model.virtualization] as string;
      const strong = model.virtualization === picture.model;
      annotations.arrow(axis, tip, strong ? 1.7 : 1.2, own, strong ? 14 : 12);
      if (shown.labels) labels.push({ at: tip, text: small(Math.hypot(x, y), unit), awayFrom: axis, colour: legible(own, theme), strong });
    }
    annotations.dot(axis, 1.8, colours.ink, 15);
  }
  if (shown.frames) {
    frame(annotations, labels, new Vector3(), (way) => way, 'b', colours.axes, shown.labels);
    if (placed && found) {
      const basis = columns(found.pose.rotation);
      const turn = ({ x, y, z }: Vector3) =>
        new Vector3().addScaledVector(basis[0], x).addScaledVector(basis[1], y).addScaledVector(basis[2], z);
      frame(annotations, labels, placed.center, turn, 'p', colours.axes, shown.labels);
    }
  }
  annotations.end();
  return labels;
}

/** Colours that carry text have to be darker on light ground. */
export function legible(colour: string, theme: Theme): string {
  if (theme === 'dark') return colour;
  const darker: Record<string, string> = { '#e69f00': '#8a5f00', '#56b4e9': '#1d6f9f', '#cc79a7': '#9b3f73', '#787878': '#5a5a5a' };
  return darker[colour] ?? colour;
}

function place(origin: number[], rotation: number[][], sockets: Point[], balls: Vector3[], exaggeration: number): Placed {
  const [ex, ey, ez] = columns(rotation);
  const center = new Vector3(...(origin as Triple)).multiplyScalar(MM);
  const turn = ([x, y]: Point) => new Vector3().addScaledVector(ex, x).addScaledVector(ey, y);
  const seats = sockets.map((socket, k) => {
    const ball = balls[k] as Vector3;
    const gap = ball.clone().sub(center.clone().add(turn(socket)));
    return new Vector3(...seat(ball.toArray(), gap.toArray(), exaggeration));
  });
  const to = seats.map((one) => one.toArray()) as [Triple, Triple, Triple];
  const matrix = new Matrix4().fromArray(planeMap(sockets as [Point, Point, Point], to, ez.toArray()));
  return { matrix, center: new Vector3().applyMatrix4(matrix), normal: ez, seats, turn };
}

function columns(rotation: number[][]): [Vector3, Vector3, Vector3] {
  const column = (i: number) => new Vector3(rotation[0]![i], rotation[1]![i], rotation[2]![i]);
  return [column(0), column(1), column(2)];
}

/** Thin lines along which a model's joints move, as in the paper's Figs. 3 and 4; from the seat. */
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
  annotations: Annotations,
  labels: Label[],
  origin: Vector3,
  turn: (way: Vector3) => Vector3,
  name: 'b' | 'p',
  colours: [string, string, string],
  labelled: boolean,
): void {
  const names = ['x', 'y', 'z'];
  [new Vector3(1, 0, 0), new Vector3(0, 1, 0), new Vector3(0, 0, 1)].forEach((axis, i) => {
    const colour = colours[i] as string;
    const tip = origin.clone().add(turn(axis).multiplyScalar(name === 'b' ? 46 : 38));
    annotations.arrow(origin, tip, 0.9, colour, 8);
    if (labelled && name === 'b') labels.push({ at: tip, text: names[i] as string, colour, offset: [6, 0] });
  });
  if (labelled && name === 'b') labels.push({ at: origin, text: 'O_b', offset: [-8, 10] });
}
