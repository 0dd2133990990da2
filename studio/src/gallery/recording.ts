// Recorded motions of the gallery: files that `crates/jointplay-studio` computes, in the form that the renderer takes.

import type { MechanismDocument, PlacedDocument } from '../api/client';

/** An entry of `index.json`. */
export interface Entry {
  name: string;
  title: string;
  /** Driven joint coordinates. */
  driven: string[];
}

/** A mechanism with the poses of its links along a motion, each as place [m] and two rows of the rotation. */
export interface Recording extends Pick<MechanismDocument, 'name' | 'source' | 'links' | 'joints' | 'virtual_joints' | 'size_m' | 'view_direction' | 'bar_radius_m' | 'joint_radius_m'> {
  driven: string[];
  poses: number[][][];
}

/** What the renderer draws: the rest of the document is for panels. */
export const drawn = (recording: Recording): MechanismDocument => recording as unknown as MechanismDocument;

/** The poses of a recording, in their order. */
export const placed = (recording: Recording): PlacedDocument[][] => recording.poses.map((links) => links.map(pose));

function pose(numbers: number[]): PlacedDocument {
  const [x, y, z, a, b, c, d, e, f] = numbers as [number, number, number, number, number, number, number, number, number];
  // The third row completes the rotation.
  return { origin_m: [x, y, z], rotation: [[a, b, c], [d, e, f], [b * f - c * e, c * d - a * f, a * e - b * d]] };
}
