// The server's API. Types come from its own description, `openapi.json`, by `npm run types`.

import type { Command, Metric, Motion } from '../lib/document';
import { lineChange } from '../lib/lineChange';
import { unpack } from '../lib/motion';
import { metres, radians } from '../lib/units';
import { connection } from './connection.svelte';
import type { components } from './schema';

type Schemas = components['schemas'];
export type RobotDocument = Schemas['RobotDocument'];
export type PoseDocument = Schemas['PoseDocument'];
export type ModelDocument = Schemas['ModelDocument'];
export type AnswerDocument = Schemas['AnswerDocument'];
export type MobilityDocument = Schemas['MobilityDocument'];
export type CellDocument = Schemas['CellDocument'];
export type PlanDocument = Schemas['PlanDocument'];
export type InstructionDocument = Schemas['InstructionReport'];
export type StationDocument = Schemas['StationDocument'];
export type JogDocument = Schemas['JogDocument'];
/** Where the robot of the cell is moved to, in m and rad. */
export type Jog = Schemas['Jog'];
export type JogQuestion = Omit<Schemas['JogRequest'], 'cell' | 'program' | 'plan'>;
export type ViolationDocument = Schemas['ViolationReport'];
export type CellText = Schemas['CellText'];
/** The pose of the robot that a station is taught by. */
export type TaughtBy = Schemas['TaughtByFields'];
export type StationChange = Omit<Schemas['StationRequest'], 'cell' | 'station'>;
export type ModelChoice = Schemas['ModelChoice'];
/** A command as the API takes it, in m and rad. */
export type ApiCommand = Schemas['Command'];

/** The server says no, and why. */
export class ApiError extends Error {
  readonly field: string | undefined;
  readonly status: number;

  constructor(status: number, detail: string, field?: string) {
    super(detail);
    this.status = status;
    this.field = field;
  }
}

/** The server does not answer at all. */
export class ConnectionError extends Error {}

const ROOT = './api/v1';

async function ask(path: string, body?: unknown, signal?: AbortSignal, method = 'POST'): Promise<Response> {
  let response: Response;
  try {
    response = await fetch(`${ROOT}/${path}`, {
      ...(body === undefined
        ? {}
        : { method, headers: { 'content-type': 'application/json' }, body: JSON.stringify(body) }),
      ...(signal ? { signal } : {}),
    });
  } catch (error) {
    if (error instanceof DOMException && error.name === 'AbortError') throw error;
    connection.failed();
    throw new ConnectionError('the server does not respond');
  }
  connection.answered();
  if (response.ok) return response;
  const problem = (await response.json().catch(() => ({}))) as Partial<Schemas['Problem']>;
  throw new ApiError(response.status, problem.detail ?? `the server responded with status ${response.status}`, problem.field ?? undefined);
}

/** The body of an answer; a server that ends in the middle of it does not answer. */
async function body<T>(answer: Promise<Response>, read: (response: Response) => Promise<unknown>): Promise<T> {
  const response = await answer;
  try {
    return (await read(response)) as T;
  } catch (error) {
    if (error instanceof DOMException && error.name === 'AbortError') throw error;
    connection.failed();
    throw new ConnectionError('the server closed the connection before the end of its response');
  }
}
const json = <T>(answer: Promise<Response>) => body<T>(answer, (response) => response.json());
const buffer = (answer: Promise<Response>) => body<ArrayBuffer>(answer, (response) => response.arrayBuffer());
const blob = (answer: Promise<Response>) => body<Blob>(answer, (response) => response.blob());

export async function robot(): Promise<RobotDocument> {
  return json(ask('robot'));
}

/** A shape that the robot file names. */
export async function mesh(part: 'base' | 'platform'): Promise<ArrayBuffer> {
  return buffer(ask(`meshes/${part}`));
}

export function modelChoice(virtualization: string, solver: string, metric: Metric): ModelChoice {
  const choice = { virtualization, solver } as ModelChoice;
  return typeof metric === 'number'
    ? { ...choice, characteristic_length_m: metres(metric) }
    : { ...choice, metric };
}

export function toApiCommand(command: Command): ApiCommand {
  if (command.kind === 'rods') return { kind: 'rods', rods_m: command.rods_mm.map(metres) };
  const height = { kind: command.height_kind, value_m: metres(command.height_mm) };
  return command.kind === 'tilt'
    ? { kind: 'tilt', yaw_rad: radians(command.yaw_deg), pitch_rad: radians(command.pitch_deg), height }
    : { kind: 'tilt_xy', about_x_rad: radians(command.about_x_deg), about_y_rad: radians(command.about_y_deg), height };
}

/**
 * One pose under several models; a height of the platform's centre is that of the first.
 * With the rods from which it comes, a robot within its limits stops where its way meets one.
 */
export async function pose(command: ApiCommand, models: ModelChoice[], from_rods_m: number[] | null): Promise<PoseDocument> {
  const from = from_rods_m ? { from_rods_m } : {};
  return json(ask('pose', { command, models, ...from }));
}

/** What is plotted of a motion, or moves the robot. */
const QUANTITIES = ['rods', 'sides', 'virtual_joints', 'origin', 'twist'];

/** The series of a motion under one model, as a stream in Arrow's format. */
export async function study(motion: Motion, model: ModelChoice, signal: AbortSignal): Promise<ReadableStream<Uint8Array>> {
  const response = await ask('study', { motion: apiMotion(motion), model, quantities: QUANTITIES }, signal);
  if (!response.body) throw new ConnectionError('the response of the server is empty');
  return response.body;
}

/** The same as a file; as Parquet only where the server was built with it. */
export async function studyFile(motion: Motion, model: ModelChoice, kind: 'csv' | 'parquet'): Promise<Blob> {
  return blob(ask(`study.${kind}`, { motion: apiMotion(motion), model }));
}

/** What `jointplay forward --format json` prints of these rods. */
export async function forward(rods_m: number[], model: ModelChoice): Promise<Blob> {
  return blob(ask('forward', { rods_m, model, ignore_limits: true }));
}

/** Samples a second of a motion through key poses: as many as a screen shows. */
export const KEY_RATE_HZ = 60;

function apiMotion(motion: Motion): Schemas['StudyRequest']['motion'] {
  if (motion.kind === 'key-poses')
    return {
      kind: 'keys',
      rate_hz: KEY_RATE_HZ,
      keys: motion.poses.map(({ about_x_deg, about_y_deg, height_mm, seconds }) => ({
        about_x_rad: radians(about_x_deg),
        about_y_rad: radians(about_y_deg),
        axis_height_m: metres(height_mm),
        duration_s: seconds,
      })),
    };
  return {
    kind: motion.kind,
    yaw_deg: { from: 0, to: 360, step: motion.yaw_step_deg },
    pitch_deg: { from: motion.pitch_from_deg, to: motion.pitch_to_deg, step: motion.pitch_step_deg },
    axis_height_m: metres(motion.height_mm),
  };
}

// The cell

export interface CellTexts {
  cell: string;
  program: string;
}

export async function cell(): Promise<CellDocument> {
  return json(ask('cell'));
}

/** Keeps both texts in their files; where they are to replace a version, not if the files have changed since. */
export async function saveCell(texts: CellTexts, replaces: string | null): Promise<CellDocument> {
  const body = replaces === null ? texts : { ...texts, replaces };
  return json(ask('cell', body, undefined, 'PUT'));
}

/** The robot of the cell, moved by hand; a plan that the server has forgotten is sent again. */
export async function jog(planned: { texts: CellTexts; key: string }, question: JogQuestion): Promise<JogDocument> {
  try {
    return await json<JogDocument>(ask('cell/jog', { plan: planned.key, ...question }));
  } catch (error) {
    if (!(error instanceof ApiError && error.status === 404)) throw error;
  }
  return json(ask('cell/jog', { ...planned.texts, ...question }));
}

/** What a program comes to in a cell; of texts that the server has planned before, only what changed is sent. */
export async function plan(texts: CellTexts, before: { texts: CellTexts; key: string } | null, signal: AbortSignal): Promise<PlanDocument> {
  if (before)
    try {
      const since = { plan: before.key, cell: lineChange(before.texts.cell, texts.cell), program: lineChange(before.texts.program, texts.program) };
      return await json<PlanDocument>(ask('cell/plan', { since }, signal));
    } catch (error) {
      if (!(error instanceof ApiError && error.field === 'since')) throw error;
    }
  return json(ask('cell/plan', texts, signal));
}

/** The cell standing still, as binary glTF. */
export async function cellScene(key: string, signal: AbortSignal): Promise<ArrayBuffer> {
  return buffer(ask(`cell/scenes/${key}`, undefined, signal));
}

/** What happens in a window of a motion. */
export async function cellWindow(key: string): Promise<ArrayBuffer> {
  return buffer(ask(`cell/windows/${key}`));
}

/** Least and largest values of all axes in windows of a plan. */
export async function cellOverview(plan: string, windows: number[]): Promise<Float64Array> {
  return unpack(await buffer(ask('cell/overview', { plan, windows }))).numbers;
}

/** A hundred instructions of a plan, by the number of their page. */
export async function cellInstructions(plan: string, page: number): Promise<Schemas['InstructionsPage']> {
  return json(ask(`cell/plans/${plan}/instructions/${page}`));
}

/** The text of the cell with new values of one station; its comments stay. */
export async function setStation(text: string, station: string, change: StationChange): Promise<CellText> {
  return json(ask('cell/station', { cell: text, station, ...change }));
}
