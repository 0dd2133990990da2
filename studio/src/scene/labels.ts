import { Vector3, type Camera } from 'three';

export interface Label {
  position: Vector3;
  text: string;
  colour?: string;
  /** Offset of the text from the point [px]. */
  offset?: [number, number];
  /** The text is placed on the side of its point that faces away from this point. */
  awayFrom?: Vector3;
  strong?: boolean;
  /** The label is omitted where it would overlap another one. */
  optional?: boolean;
}

/** Paints labels between the covered margins of the view; an overlapping label is moved down. */
export function paintLabels(
  context: CanvasRenderingContext2D,
  labels: Label[],
  camera: Camera,
  size: { width: number; height: number },
  covered: { left: number; right: number },
  ink: { text: string; halo: string },
): void {
  const occupied: [number, number, number, number][] = [];
  const projected = new Vector3();
  context.textBaseline = 'middle';
  context.lineJoin = 'round';
  const from = new Vector3();
  for (const { position, text, colour, offset, awayFrom, strong, optional } of labels) {
    projected.copy(position).project(camera);
    if (projected.z > 1 || projected.z < -1) continue;
    let [right, down] = offset ?? [0, 0];
    if (awayFrom) {
      from.copy(awayFrom).project(camera);
      const away = [(projected.x - from.x) * size.width, (from.y - projected.y) * size.height] as const;
      const distance = Math.hypot(...away) || 1;
      right = Math.abs(away[0]) > 0.25 * distance ? Math.sign(away[0]) * 10 : 0;
      down = (away[1] / distance) * 12;
    }
    context.font = `${strong ? 600 : 400} 12px system-ui, sans-serif`;
    const width = context.measureText(text).width;
    const preferred = ((projected.x + 1) / 2) * size.width + right - (right < 0 ? width : right === 0 ? width / 2 : 0);
    const x = Math.max(Math.min(preferred, size.width - covered.right - width), covered.left);
    let y = ((1 - projected.y) / 2) * size.height + down;
    const overlaps = () => occupied.some(([l, t, r, b]) => x < r && x + width > l && y - 8 < b && y + 8 > t);
    for (let tries = 0; tries < 6 && overlaps(); tries++) y += 15;
    if (optional && overlaps()) continue;
    occupied.push([x - 2, y - 8, x + width + 2, y + 8]);
    context.lineWidth = 4;
    context.strokeStyle = ink.halo;
    context.strokeText(text, x, y);
    context.fillStyle = colour ?? ink.text;
    context.fillText(text, x, y);
  }
}
