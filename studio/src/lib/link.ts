// Conversion of a document and a view to the readable fragment of a URL, and back.

import { clampedScale } from './playScale';
import {
  SOLVERS,
  VIRTUALIZATIONS,
  type Command,
  type Document,
  type HeightKind,
  type KeyPose,
  type Metric,
  type Motion,
  type Shown,
} from './document';

/** The robot of a link. */
export interface RobotIdentity {
  name: string;
  /** Fingerprint of geometry and limits: two robots may have the same name. */
  print: string;
}

export interface View {
  /** Position and target of the camera [mm]. */
  eye_mm: [number, number, number];
  target_mm: [number, number, number];
  projection: 'perspective' | 'orthographic';
  /** Zoom of the orthographic camera. */
  zoom: number;
}

export interface Linked {
  /** The robot that the link was created with; older links have none. */
  robot: RobotIdentity | null;
  document: Document;
  view: View | null;
  sample: number | null;
}

const SHOWN: (keyof Shown)[] = ['joints', 'ghost', 'others', 'arrows', 'frames', 'labels'];

export function toHash({ robot, document: chosen, view, sample }: Linked): string {
  const parts: [string, string][] = [
    ...(robot ? [['robot', `${encodeURIComponent(robot.name)},${robot.print}`] as [string, string]] : []),
    ['pose', poseText(chosen.command)],
    ['model', [chosen.model, chosen.solver, chosen.metric].join(',')],
    ['play', String(chosen.exaggeration)],
    ['show', SHOWN.filter((name) => chosen.shown[name]).join(',')],
  ];
  if (chosen.motion) parts.push(['motion', motionText(chosen.motion)]);
  if (chosen.motion && sample !== null) parts.push(['sample', String(sample)]);
  if (view) parts.push(['view', viewText(view)]);
  return '#' + parts.map(([key, value]) => `${key}=${value}`).join('&');
}

/** Parses a link; missing and invalid parts have the values of `otherwise`. */
export function fromHash(hash: string, otherwise: Document): Linked {
  const parts = new Map<string, string>();
  for (const part of hash.replace(/^#/, '').split('&')) {
    const at = part.indexOf('=');
    if (at > 0) parts.set(part.slice(0, at), decode(part.slice(at + 1)));
  }
  const words = (key: string) => (parts.get(key) ?? '').split(',');
  const [model, solver, metric] = words('model');
  const play = number(parts.get('play'));
  const show = parts.has('show') ? words('show') : null;
  const motion = parseMotion(parts.get('motion')) ?? (parts.size > 0 ? null : otherwise.motion);
  const sample = number(parts.get('sample'));
  return {
    robot: parseRobot(parts.get('robot')),
    document: {
      command: parsePose(words('pose')) ?? otherwise.command,
      model: VIRTUALIZATIONS.find((name) => name === model) ?? otherwise.model,
      solver: SOLVERS.find((name) => name === solver) ?? otherwise.solver,
      metric: parseMetric(metric) ?? otherwise.metric,
      exaggeration:
        play === null ? otherwise.exaggeration : clampedScale(play),
      shown: show
        ? (Object.fromEntries(SHOWN.map((name) => [name, show.includes(name)])) as unknown as Shown)
        : otherwise.shown,
      motion,
      robotFile: otherwise.robotFile,
    },
    view: parseView(words('view')),
    sample: motion && sample !== null && Number.isInteger(sample) && sample >= 0 ? sample : null,
  };
}

function parseRobot(text: string | undefined): RobotIdentity | null {
  const found = /^(.*),([0-9a-f]{8})$/s.exec(text ?? '');
  return found && { name: found[1] as string, print: found[2] as string };
}

/** Hash of a value in eight hexadecimal digits (FNV-1a over its JSON). */
export function fingerprint(thing: unknown): string {
  let hash = 0x811c9dc5;
  for (const byte of new TextEncoder().encode(JSON.stringify(thing))) hash = Math.imul(hash ^ byte, 0x01000193);
  return (hash >>> 0).toString(16).padStart(8, '0');
}

function decode(text: string): string {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}

function number(text: string | undefined): number | null {
  if (text === undefined || text.trim() === '') return null;
  const value = Number(text);
  return Number.isFinite(value) ? value : null;
}

function numbers(words: string[], count: number): number[] | null {
  const values = words.map(number);
  return values.length === count && values.every((value) => value !== null) ? (values as number[]) : null;
}

function poseText(command: Command): string {
  switch (command.kind) {
    case 'tilt':
      return ['tilt', command.azimuth_deg, command.tilt_deg, command.height_mm, command.height_kind].join(',');
    case 'tilt_xy':
      return ['xy', command.about_x_deg, command.about_y_deg, command.height_mm, command.height_kind].join(',');
    case 'rods':
      return ['rods', ...command.rods_mm].join(',');
  }
}

function parsePose([kind, ...rest]: string[]): Command | null {
  if (kind === 'rods') {
    const rods = numbers(rest, 3);
    return rods && { kind: 'rods', rods_mm: rods as [number, number, number] };
  }
  const values = numbers(rest.slice(0, 3), 3);
  const height_kind: HeightKind | null = rest[3] === 'axis' || rest[3] === 'center' ? rest[3] : null;
  if (!values || !height_kind) return null;
  const [first, second, height_mm] = values as [number, number, number];
  if (kind === 'tilt') return { kind, azimuth_deg: first, tilt_deg: second, height_mm, height_kind };
  if (kind === 'xy') return { kind: 'tilt_xy', about_x_deg: first, about_y_deg: second, height_mm, height_kind };
  return null;
}

function parseMetric(text: string | undefined): Metric | null {
  if (text === 'paper' || text === 'radius') return text;
  const value = number(text);
  return value !== null && value > 0 ? value : null;
}

function motionText(motion: Motion): string {
  if (motion.kind === 'key-poses') {
    const poses = motion.poses.map((pose) => [pose.about_x_deg, pose.about_y_deg, pose.height_mm, pose.seconds].join(','));
    return ['key-poses', ...poses].join(';');
  }
  const { kind, azimuth_step_deg, tilt_from_deg, tilt_to_deg, tilt_step_deg, height_mm } = motion;
  return [kind, azimuth_step_deg, tilt_from_deg, tilt_to_deg, tilt_step_deg, height_mm].join(',');
}

function parseMotion(text: string | undefined): Motion | null {
  if (text === undefined) return null;
  if (text.startsWith('key-poses;')) {
    const poses: KeyPose[] = [];
    for (const part of text.split(';').slice(1)) {
      const values = numbers(part.split(','), 4);
      if (!values) return null;
      const [about_x_deg, about_y_deg, height_mm, seconds] = values as [number, number, number, number];
      poses.push({ about_x_deg, about_y_deg, height_mm, seconds });
    }
    return { kind: 'key-poses', poses };
  }
  const [kind, ...rest] = text.split(',');
  const values = numbers(rest, 5);
  if ((kind !== 'raster' && kind !== 'serpentine') || !values) return null;
  const [azimuth_step_deg, tilt_from_deg, tilt_to_deg, tilt_step_deg, height_mm] = values as [
    number,
    number,
    number,
    number,
    number,
  ];
  return { kind, azimuth_step_deg, tilt_from_deg, tilt_to_deg, tilt_step_deg, height_mm };
}

function viewText(view: View): string {
  const [eye, target] = [view.eye_mm, view.target_mm];
  // A thousandth of the distance, and at most 0.1 mm.
  const decimals = Math.max(1, 3 - Math.floor(Math.log10(Math.max(Math.hypot(...eye.map((value, i) => value - target[i]!)), 1e-6))));
  const round = (value: number) => Number(value.toFixed(decimals));
  const letter = view.projection === 'orthographic' ? 'o' : 'p';
  const zoom = Math.round(view.zoom * 1000) / 1000;
  return [letter, ...view.eye_mm.map(round), ...view.target_mm.map(round), zoom].join(',');
}

function parseView([letter, ...rest]: string[]): View | null {
  const values = numbers(rest, 7);
  if (!values || (letter !== 'o' && letter !== 'p')) return null;
  return {
    eye_mm: values.slice(0, 3) as View['eye_mm'],
    target_mm: values.slice(3, 6) as View['target_mm'],
    projection: letter === 'o' ? 'orthographic' : 'perspective',
    zoom: values[6] as number,
  };
}
