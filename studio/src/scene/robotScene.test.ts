import { Matrix4, Vector3 } from 'three';
import { describe, expect, test } from 'vitest';
import type { ModelDocument, PoseDocument, RobotDocument } from '../api/client';
import { Annotations } from './annotations';
import { RobotMaterials, RobotModel } from './robotModel';
import { updateRobotScene } from './robotScene';
import { sceneUnits } from './robotSize';

/** A platform that is not regular, in an invented pose with play, torsion and shift. */
const SOCKETS: [number, number][] = [[0.093, 0.004], [-0.05, 0.081], [-0.041, -0.084]];
const [TILT, TORSION, SHIFT, HEIGHT] = [0.021, 2.4e-5, [6.1e-6, -8.3e-6], 0.487] as const;

const rotation = new Matrix4().makeRotationAxis(new Vector3(0.6, 0.8, 0), TILT).multiply(new Matrix4().makeRotationZ(TORSION));
const rows = [0, 1, 2].map((row) => [0, 1, 2].map((column) => rotation.elements[4 * column + row]!));
const origin = [SHIFT[0], SHIFT[1], HEIGHT + 1e-7];
const moves = [[9e-6, 3e-6], [-4e-6, 11e-6], [2e-6, -7e-6]] as const;
const moved = SOCKETS.map(([x, y], k) => [x + moves[k]![0], y + moves[k]![1]]);
const answer = { pose: { origin_m: origin, rotation: rows }, torsion_rad: TORSION, center_shift_m: [...SHIFT], sockets_m: moved, virtual_joints: [] };
const pose = {
  axis_height_m: HEIGHT,
  approximate: { pose: { origin_m: [0, 0, HEIGHT], rotation: rows }, gaps_m: moves.map(([x, y]) => [x, y, 0]) },
  models: [{ model: { virtualization: 'planar' }, answer } as unknown as ModelDocument],
} as unknown as PoseDocument;
const robot = { limbs: SOCKETS.map((socket_m) => ({ socket_m, socket_radius_m: Math.hypot(...socket_m) })), virtualizations: [] } as unknown as RobotDocument;
const shown = { joints: false, ghost: false, others: false, arrows: false, frames: false, labels: false };

function displayed(exaggeration: number): { balls: Vector3[]; platform: Matrix4; gap: number } {
  const mm = SOCKETS.map(([x, y]) => [1000 * x, 1000 * y] as [number, number]);
  const body = new RobotModel({ bases: mm, sockets: mm }, new RobotMaterials());
  let placed: { balls: Vector3[]; platform: Matrix4; gap: number } | null = null;
  const place = body.place.bind(body);
  body.place = (balls, platform, gap) => {
    placed = { balls, platform, gap };
    place(balls, platform, gap);
  };
  updateRobotScene({ robot, pose, model: 'planar', exaggeration, shown, theme: 'light', unit: 'mm' }, body, new Annotations());
  return placed!;
}

describe('the displayed robot', () => {
  for (const exaggeration of [1, 37, 500, 2000])
    test(`is rigid, and the gaps of its bearings have the play scale ${exaggeration}`, () => {
      const { balls, platform, gap } = displayed(exaggeration);
      const [x, y, z] = [0, 1, 2].map((column) => new Vector3().setFromMatrixColumn(platform, column)) as [Vector3, Vector3, Vector3];
      for (const axis of [x, y, z]) expect(axis.length()).toBeCloseTo(1, 9);
      expect(x.dot(y)).toBeCloseTo(0, 9);
      expect(x.clone().cross(y).distanceTo(z)).toBeLessThan(1e-9);
      SOCKETS.forEach(([sx, sy], k) => {
        const socket = new Vector3(1000 * sx, 1000 * sy, 0).applyMatrix4(platform);
        const [dx, dy] = moves[k]!;
        expect(balls[k]!.distanceTo(socket)).toBeCloseTo(1000 * exaggeration * Math.hypot(dx, dy), 6);
        expect(gap).toBeGreaterThanOrEqual(balls[k]!.distanceTo(socket) - 1e-9);
      });
      // The shift of the centre has the play scale.
      const center = new Vector3().setFromMatrixPosition(platform);
      expect(center.x).toBeCloseTo(1000 * exaggeration * SHIFT[0], 6);
      expect(center.y).toBeCloseTo(1000 * exaggeration * SHIFT[1], 6);
    });

  test('is the real one at a play scale of 1', () => {
    const { balls, platform } = displayed(1);
    platform.elements.slice(0, 11).forEach((value, i) => expect(value).toBeCloseTo(rotation.elements[i]!, 9));
    balls.forEach((ball, k) => {
      const real = new Vector3(moved[k]![0]!, moved[k]![1]!, 0).applyMatrix4(rotation).add(new Vector3(...origin)).multiplyScalar(1000);
      expect(ball.distanceTo(real)).toBeLessThan(1e-9);
    });
  });
});

test('robots of 1 mm and of 10 m have the picture of a robot of their shape', () => {
  const scaled = (by: number) => {
    const times = (values: readonly number[]) => values.map((value) => value * by);
    const limbs = SOCKETS.map((socket) => ({ socket_m: times(socket), socket_radius_m: by * Math.hypot(...socket) }));
    const placed = ({ origin_m, rotation }: typeof answer.pose) => ({ origin_m: times(origin_m), rotation });
    return {
      robot: { limbs, virtualizations: [] } as unknown as RobotDocument,
      pose: {
        axis_height_m: by * HEIGHT,
        approximate: { pose: placed({ origin_m: [0, 0, HEIGHT], rotation: rows }), gaps_m: moves.map(([x, y]) => times([x, y, 0])) },
        models: [{ model: { virtualization: 'planar' }, answer: { ...answer, pose: placed(answer.pose), center_shift_m: times(SHIFT), sockets_m: moved.map(times) } }],
      } as unknown as PoseDocument,
    };
  };
  const center = (by: number) => {
    const { robot, pose } = scaled(by);
    const units = sceneUnits(robot.limbs);
    const sockets = robot.limbs.map(({ socket_m: [x, y] }) => [x! * units, y! * units] as [number, number]);
    const body = new RobotModel({ bases: sockets, sockets }, new RobotMaterials());
    updateRobotScene({ robot, pose, model: 'planar', exaggeration: 500, shown, theme: 'light', unit: 'mm' }, body, new Annotations());
    return { radius: Math.max(...sockets.map((socket) => Math.hypot(...socket))), center: new Vector3().setFromMatrixPosition(body.platform.matrix) };
  };
  // Sizes of the robots: 1 mm, 3 mm, 10 m and 30 m.
  const [tiny, small, large, huge] = [0.01, 0.03, 100, 300].map(center) as [ReturnType<typeof center>, ReturnType<typeof center>, ReturnType<typeof center>, ReturnType<typeof center>];
  expect(small.center.distanceTo(tiny.center)).toBeLessThan(1e-6);
  expect(huge.center.distanceTo(large.center)).toBeLessThan(1e-6);
  // Balls of 8.5 and rims of 34 units fit to these radii.
  for (const { radius } of [tiny, small, large, huge]) {
    expect(radius).toBeGreaterThan(40);
    expect(radius).toBeLessThan(250);
  }
});
