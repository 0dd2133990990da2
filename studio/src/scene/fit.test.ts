import { Box3, PerspectiveCamera, Vector3 } from 'three';
import { expect, test } from 'vitest';
import { fittingDistance } from './fit';

test('all corners of a box are in the picture at the fitting distance, and the nearest one is at its edge', () => {
  const box = new Box3(new Vector3(-0.9, -0.8, 0), new Vector3(0.9, 0.8, 1.1));
  for (const aspect of [0.6, 1, 1.12, 1.8])
    for (const direction of [new Vector3(-1, -1.4, 1.1), new Vector3(0, 0, 1), new Vector3(0, -1, 0), new Vector3(-1, 0, 0)]) {
      const camera = new PerspectiveCamera(32, aspect, 0.02, 60);
      camera.up.set(0, 0, 1);
      const center = box.getCenter(new Vector3());
      camera.position.copy(center).addScaledVector(direction.clone().normalize(), fittingDistance(camera, box, direction, 1));
      if (direction.x === 0 && direction.y === 0) camera.up.set(0, 1, 0);
      camera.lookAt(center);
      camera.updateMatrixWorld();
      const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((k) => new Vector3(k & 1 ? box.max.x : box.min.x, k & 2 ? box.max.y : box.min.y, k & 4 ? box.max.z : box.min.z).project(camera));
      const farthest = Math.max(...corners.map(({ x, y }) => Math.max(Math.abs(x), Math.abs(y))));
      expect(farthest, `${aspect}, ${direction.toArray()}`).toBeLessThan(1);
      expect(farthest).toBeGreaterThan(0.93);
    }
});
