import { expect, test } from 'vitest';
import { painted } from './painted';

test('canvases made within are painted by the processor, others as before', () => {
  const asked: unknown[] = [];
  class Canvas {
    getContext(kind: string, attributes?: object): unknown {
      asked.push([kind, attributes]);
      return null;
    }
  }
  const { getContext } = Canvas.prototype;
  Object.assign(globalThis, { HTMLCanvasElement: Canvas });
  const canvas = new Canvas();
  expect(painted(() => canvas.getContext('2d', { alpha: false }) ?? 'made')).toBe('made');
  expect(() => painted(() => {
    canvas.getContext('webgl2', { antialias: true });
    throw new Error('no plot');
  })).toThrow('no plot');
  canvas.getContext('2d');
  expect(asked).toEqual([
    ['2d', { alpha: false, willReadFrequently: true }],
    ['webgl2', { antialias: true }],
    ['2d', undefined],
  ]);
  expect(Canvas.prototype.getContext).toBe(getContext);
});
