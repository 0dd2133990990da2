// Labels of points of a scene: they do not overlap, and have lines to their points where these are not next to them.

import { Vector3, type Camera } from 'three';
import { hull, type Point } from '../lib/geometry';
import type { TextContext } from '../lib/svgContext';
import { distanceTo, intersect, leaderEnd, placeLabels, textParts, type Box, type TextPart } from '../lib/labelLayout';

export interface Label {
  position: Vector3;
  /** `O_b` and `l₁` have subscripts; lines are separated by `\n`. */
  text: string;
  colour?: string;
  /** Offset of the text from the point [px]. */
  offset?: [number, number];
  /** The text is placed on the side of its point that faces away from this point. */
  awayFrom?: Vector3;
  strong?: boolean;
  /** Length of the labelled part [units of the scene]: the label is hidden while it appears smaller than a text. */
  extent?: number;
  /** The label may cover the avoided parts: it stays near its point while they move past it. */
  stays?: boolean;
  /** The label is hidden while its point is behind the most important avoided part, or under other elements. */
  hides?: boolean;
}

/** Labels of a frame, and what other elements cover: widths at its left and right, and further areas of the view [px]. */
export interface Overlay {
  labels: Label[];
  /** Axes that are drawn as vectors, in pictures that have vectors. */
  axes?: AxisArrow[];
  covered: { left: number; right: number };
  occupied?: Box[];
  /** Points of convex parts that labels do not cover as long as there are other places, the most important part first. */
  avoided?: readonly (readonly Vector3[])[];
}

const FONT = { size: 12, subscript: 9, drop: 3, height: 16 } as const;
/** A part that appears shorter has no label [px]. */
const SMALLEST = 26;

interface Size {
  width: number;
  height: number;
}

const font = (strong: boolean, size: number) => `${strong ? 600 : 400} ${size}px system-ui, sans-serif`;

function measure(context: TextContext, parts: TextPart[], strong: boolean): number {
  return parts.reduce((sum, { text, subscript }) => {
    context.font = font(strong, subscript ? FONT.subscript : FONT.size);
    return sum + context.measureText(text).width;
  }, 0);
}

/** An axis that is drawn as a vector: an arrow between two points. */
export interface AxisArrow {
  from: Vector3;
  to: Vector3;
  colour: string;
}

/** Length and half of the width of the head of an arrow [px]. */
const HEAD = { length: 8, half: 3 } as const;

/** Paints axes. */
export function paintAxes(context: TextContext, axes: readonly AxisArrow[], camera: Camera, size: Size): void {
  const toPixels = (position: Vector3) => {
    const { x, y } = position.clone().project(camera);
    return [((x + 1) / 2) * size.width, ((1 - y) / 2) * size.height] as const;
  };
  context.lineWidth = 1.5;
  for (const { from, to, colour } of axes) {
    const [[x, y], [a, b]] = [toPixels(from), toPixels(to)];
    const length = Math.hypot(a - x, b - y);
    if (length < 1) continue;
    const [along, down] = [(a - x) / length, (b - y) / length];
    const head = Math.min(HEAD.length, length);
    const half = (HEAD.half * head) / HEAD.length;
    const [neckX, neckY] = [a - head * along, b - head * down];
    context.strokeStyle = context.fillStyle = colour;
    context.beginPath();
    context.moveTo(x, y);
    context.lineTo(neckX, neckY);
    context.stroke();
    context.beginPath();
    context.moveTo(a, b);
    context.lineTo(neckX - half * down, neckY + half * along);
    context.lineTo(neckX + half * down, neckY - half * along);
    context.lineTo(a, b);
    context.fill();
  }
}

/** Paints the labels of a pane of the view between its covered margins, and outside of occupied areas of the view; returns the boxes of their texts. */
export function paintLabels(
  context: TextContext,
  { labels, covered, avoided = [] }: Overlay,
  camera: Camera,
  pane: Box,
  occupied: readonly Box[],
  ink: { text: string; halo: string },
): Box[] {
  context.textBaseline = 'middle';
  context.lineJoin = 'round';
  const toPixels = (position: Vector3) => {
    const projected = position.clone().project(camera);
    return { x: pane.left + ((projected.x + 1) / 2) * (pane.right - pane.left), y: pane.top + ((1 - projected.y) / 2) * (pane.bottom - pane.top), visible: projected.z <= 1 && projected.z >= -1 };
  };
  const areas = avoided.map((points) => hull(points.map(toPixels).flatMap(({ x, y, visible }): Point[] => (visible ? [[x, y]] : [])))).filter((area) => area.length > 1);
  const isHidden = (x: number, y: number) => occupied.some((box) => distanceTo(box, x, y) === 0) || areas.slice(0, 1).some((area) => intersect(area, [[x, y]]));
  const sideways = new Vector3().setFromMatrixColumn(camera.matrixWorld, 0);
  const shown = labels.flatMap((label) => {
    const { position, text, offset, awayFrom, strong = false, extent, hides = false, stays = false } = label;
    const { x, y, visible } = toPixels(position);
    if (!visible || x < pane.left || y < pane.top || x > pane.right || y > pane.bottom) return [];
    if (hides && isHidden(x, y)) return [];
    if (extent !== undefined) {
      const side = toPixels(position.clone().addScaledVector(sideways, extent));
      if (Math.hypot(side.x - x, side.y - y) < SMALLEST) return [];
    }
    const lines = text.split('\n').map((line) => {
      const parts = textParts(line);
      return { parts, width: measure(context, parts, strong) };
    });
    const width = Math.max(...lines.map((line) => line.width));
    let [right, down] = offset ?? [0, 0];
    if (awayFrom) {
      const from = toPixels(awayFrom);
      const away = [x - from.x, y - from.y] as const;
      const distance = Math.hypot(...away) || 1;
      right = Math.abs(away[0]) > 0.25 * distance ? Math.sign(away[0]) * 10 : 0;
      down = (away[1] / distance) * 12;
    }
    // The offset is that of the near end of the text.
    return [{ label, lines, strong, stays, x, y, width, height: lines.length * FONT.height, offset: [right + Math.sign(right) * (width / 2), down] as [number, number] }];
  });
  // Strong labels get the best places.
  shown.sort((a, b) => Number(b.strong) - Number(a.strong));
  const view: Box = { left: pane.left + covered.left, top: pane.top + 2, right: pane.right - covered.right, bottom: pane.bottom - 2 };
  const placed = placeLabels(shown, view, occupied, areas);
  for (const { index, box, leader } of placed) {
    if (!leader) continue;
    const { x, y, label } = shown[index]!;
    context.lineWidth = 1;
    context.strokeStyle = label.colour ?? ink.text;
    context.beginPath();
    context.moveTo(x, y);
    context.lineTo(...leaderEnd(box, x, y));
    context.stroke();
    context.beginPath();
    context.arc(x, y, Math.min(2, distanceTo(box, x, y)), 0, 2 * Math.PI);
    context.fillStyle = label.colour ?? ink.text;
    context.fill();
  }
  for (const { index, box } of placed) {
    const { x: pointX, label, lines, strong } = shown[index]!;
    lines.forEach(({ parts, width }, line) => {
      // Lines are aligned at the side of the point.
      let x = pointX > box.right ? box.right - width : box.left;
      const y = box.top + (line + 0.5) * FONT.height;
      for (const { text, subscript } of parts) {
        context.font = font(strong, subscript ? FONT.subscript : FONT.size);
        const baseline = y + (subscript ? FONT.drop : 0);
        context.lineWidth = 4;
        context.strokeStyle = ink.halo;
        context.strokeText(text, x, baseline);
        context.fillStyle = label.colour ?? ink.text;
        context.fillText(text, x, baseline);
        x += context.measureText(text).width;
      }
    });
  }
  return placed.map(({ box }) => box);
}
