import { Vector3, type Camera } from 'three';

export interface Label {
  at: Vector3;
  text: string;
  colour?: string;
  /** Where the text stands from the point, in pixels. */
  offset?: [number, number];
  /** The text stands on the side of the point that is away from this one. */
  awayFrom?: Vector3;
  strong?: boolean;
}

/** Paints labels over the picture, between what covers it at the left and at the right; where two would overlap, the later one moves down. */
export function paintLabels(
  context: CanvasRenderingContext2D,
  labels: Label[],
  camera: Camera,
  size: { width: number; height: number },
  free: { left: number; right: number },
  ink: { text: string; halo: string },
): void {
  const taken: [number, number, number, number][] = [];
  const at = new Vector3();
  context.textBaseline = 'middle';
  context.lineJoin = 'round';
  const from = new Vector3();
  for (const { at: place, text, colour, offset, awayFrom, strong } of labels) {
    at.copy(place).project(camera);
    if (at.z > 1 || at.z < -1) continue;
    let [right, down] = offset ?? [0, 0];
    if (awayFrom) {
      from.copy(awayFrom).project(camera);
      const way = [(at.x - from.x) * size.width, (from.y - at.y) * size.height] as const;
      const far = Math.hypot(...way) || 1;
      right = Math.abs(way[0]) > 0.25 * far ? Math.sign(way[0]) * 10 : 0;
      down = (way[1] / far) * 12;
    }
    context.font = `${strong ? 600 : 400} 12px system-ui, sans-serif`;
    const width = context.measureText(text).width;
    const wanted = ((at.x + 1) / 2) * size.width + right - (right < 0 ? width : right === 0 ? width / 2 : 0);
    const x = Math.max(Math.min(wanted, size.width - free.right - width), free.left);
    let y = ((1 - at.y) / 2) * size.height + down;
    const overlaps = () => taken.some(([l, t, r, b]) => x < r && x + width > l && y - 8 < b && y + 8 > t);
    for (let tries = 0; tries < 6 && overlaps(); tries++) y += 15;
    taken.push([x - 2, y - 8, x + width + 2, y + 8]);
    context.lineWidth = 4;
    context.strokeStyle = ink.halo;
    context.strokeText(text, x, y);
    context.fillStyle = colour ?? ink.text;
    context.fillText(text, x, y);
  }
}
