// Client of the server's HTTP API. Its types are generated from `openapi.json` by `npm run types`.

import type { Command, Metric, Motion } from '../lib/document';
import { lineChange } from '../lib/lineChange';
import { unpack } from '../lib/motion';
import { metres, radians } from '../lib/units';
import { connection } from './connection.svelte';
import { messageUnit } from './lengthUnit';
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
/** Target of a jog motion [m, rad]. */
export type Jog = Schemas['Jog'];
export type JogParameters = Omit<Schemas['JogRequest'], 'cell' | 'program' | 'plan'>;
export type ViolationDocument = Schemas['ViolationReport'];
export type CellText = Schemas['CellText'];
/** Robot pose by which a station is taught. */
export type TaughtBy = Schemas['TaughtByFields'];
export type StationChange = Omit<Schemas['StationRequest'], 'cell' | 'station'>;
export type RobotSource = Schemas['RobotSource'];
export type OpenedRobotDocument = Schemas['OpenedRobotDocument'];
export type DimensionChange = Schemas['DimensionChange'];
export type ModelChoice = Schemas['ModelChoice'];
/** Command in the units of the API [m, rad]. */
export type ApiCommand = Schemas['Command'];

/** Problem document returned by the server. */
export class ApiError extends Error {
  readonly field: string | undefined;
  readonly status: number;

  constructor(status: number, detail: string, field?: string) {
    super(detail);
    this.status = status;
    this.field = field;
  }
}

/** The server does not respond. */
export class ConnectionError extends Error {}

const ROOT = './api/v1';

async function request(path: string, body?: unknown, signal?: AbortSignal, method = 'POST'): Promise<Response> {
  let response: Response;
  try {
    response = await fetch(`${ROOT}/${path}`, {
      headers: { ...messageUnit.header, ...(body === undefined ? {} : { 'content-type': 'application/json' }) },
      ...(body === undefined ? {} : { method, body: JSON.stringify(body) }),
      ...(signal ? { signal } : {}),
    });
  } catch (error) {
    if (error instanceof DOMException && error.name === 'AbortError') throw error;
    connection.failed();
    throw new ConnectionError('the server does not respond');
  }
  connection.responded();
  if (response.ok) return response;
  const problem = (await response.json().catch(() => ({}))) as Partial<Schemas['Problem']>;
  throw new ApiError(response.status, problem.detail ?? `the server responded with status ${response.status}`, problem.field ?? undefined);
}

/** Reads the body of a response; a connection that closes before its end is a connection error. */
async function body<T>(pending: Promise<Response>, read: (response: Response) => Promise<unknown>): Promise<T> {
  const response = await pending;
  try {
    return (await read(response)) as T;
  } catch (error) {
    if (error instanceof DOMException && error.name === 'AbortError') throw error;
    connection.failed();
    throw new ConnectionError('the server closed the connection before the end of its response');
  }
}
const json = <T>(pending: Promise<Response>) => body<T>(pending, (response) => response.json());
const buffer = (pending: Promise<Response>) => body<ArrayBuffer>(pending, (response) => response.arrayBuffer());
const blob = (pending: Promise<Response>) => body<Blob>(pending, (response) => response.blob());

/** The value of a length [m] or an angle [rad] as typed: an expression, with or without a unit of its own. */
export async function quantity(text: string, unit: Schemas['TypedUnit']): Promise<number> {
  return (await json<Schemas['QuantityDocument']>(request('quantity', { text, unit }))).value;
}

export async function robot(): Promise<RobotDocument> {
  return json(request('robot'));
}

/** The file of the robot of the server. */
export async function robotFile(): Promise<Schemas['RobotFileDocument']> {
  return json(request('robot/file'));
}

/** Saves the text of the robot file; with `replaces`, only if the file on disk still has this version. */
export async function saveRobot(text: string, replaces: string | null): Promise<Schemas['RobotFileDocument']> {
  return json(request('robot/file', replaces === null ? { text } : { text, replaces }, undefined, 'PUT'));
}

/** A robot from the text of a file, after changes of its numbers. */
export async function openRobot(robot: RobotSource, changes: DimensionChange[]): Promise<OpenedRobotDocument> {
  return json(request('robot/open', { robot, changes }));
}

/** The robot of a request; that of the server without a source. */
const ofRobot = (robot: RobotSource | null) => (robot ? { robot } : {});

/** Contents of a mesh file named in the robot file. */
export async function mesh(part: 'base' | 'platform'): Promise<ArrayBuffer> {
  return buffer(request(`meshes/${part}`));
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
    ? { kind: 'tilt', azimuth_rad: radians(command.azimuth_deg), tilt_rad: radians(command.tilt_deg), height }
    : { kind: 'tilt_xy', about_x_rad: radians(command.about_x_deg), about_y_rad: radians(command.about_y_deg), height };
}

/** What happens to a command beyond the limits: it is shown, the robot stops on the straight line from other rods, or it slides along the limits. */
export type AtLimits = { show: true } | { stop: number[] | null } | { slide: true };

/** One pose under several models; a height of the platform centre refers to the first model. */
export async function pose(robot: RobotSource | null, command: ApiCommand, models: ModelChoice[], at_limits: AtLimits): Promise<PoseDocument> {
  const from = 'slide' in at_limits ? { at_limits: 'slide' } : 'stop' in at_limits && at_limits.stop ? { from_rods_m: at_limits.stop } : {};
  return json(request('pose', { command, models, ...from, ...ofRobot(robot) }));
}

/** Quantities that the page plots or needs to display the robot. */
export const QUANTITIES = ['rods', 'sides', 'virtual_joints', 'origin', 'torsion', 'displacement'];

/** Quantities by which models are compared. */
export const COMPARED_QUANTITIES = ['sides', 'virtual_joints', 'origin', 'torsion', 'displacement'];

/** Time series of a motion under one model, as an Arrow stream. */
export async function study(robot: RobotSource | null, motion: Motion, model: ModelChoice, quantities: readonly string[], signal: AbortSignal): Promise<ReadableStream<Uint8Array>> {
  const response = await request('study', { motion: apiMotion(motion), model, quantities, ...ofRobot(robot) }, signal);
  if (!response.body) throw new ConnectionError('the response of the server is empty');
  return response.body;
}

/** Time series of a motion as a file; Parquet only if the server supports it. */
export async function studyFile(robot: RobotSource | null, motion: Motion, model: ModelChoice, kind: 'csv' | 'parquet', signal: AbortSignal): Promise<Blob> {
  return blob(request(`study.${kind}`, { motion: apiMotion(motion), model, ...ofRobot(robot) }, signal));
}

/** Output of `jointplay forward --format json` for given rods. */
export async function forward(robot: RobotSource | null, rods_m: number[], model: ModelChoice, signal: AbortSignal): Promise<Blob> {
  return blob(request('forward', { rods_m, model, ignore_limits: true, ...ofRobot(robot) }, signal));
}

/** Sampling rate of motions through key poses [Hz]: that of a screen. */
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
    azimuth_deg: { from: 0, to: 360, step: motion.azimuth_step_deg },
    tilt_deg: { from: motion.tilt_from_deg, to: motion.tilt_to_deg, step: motion.tilt_step_deg },
    axis_height_m: metres(motion.height_mm),
  };
}

// The cell

export interface CellTexts {
  cell: string;
  program: string;
}

export async function cell(): Promise<CellDocument> {
  return json(request('cell'));
}

/** Saves both texts; with `replaces`, only if the files on disk still have this version. */
export async function saveCell(texts: CellTexts, replaces: string | null): Promise<CellDocument> {
  const body = replaces === null ? texts : { ...texts, replaces };
  return json(request('cell', body, undefined, 'PUT'));
}

/** Jogs the robot of the cell; sends the texts if the server no longer has the plan. */
export async function jog(planned: { texts: CellTexts; key: string }, parameters: JogParameters): Promise<JogDocument> {
  try {
    return await json<JogDocument>(request('cell/jog', { plan: planned.key, ...parameters }));
  } catch (error) {
    if (!(error instanceof ApiError && error.status === 404)) throw error;
  }
  return json(request('cell/jog', { ...planned.texts, ...parameters }));
}

/** Plans a program in a cell; sends only the changed lines if the server may have the previous plan. */
export async function plan(texts: CellTexts, previous: { texts: CellTexts; key: string } | null, signal: AbortSignal): Promise<PlanDocument> {
  if (previous)
    try {
      const since = { plan: previous.key, cell: lineChange(previous.texts.cell, texts.cell), program: lineChange(previous.texts.program, texts.program) };
      return await json<PlanDocument>(request('cell/plan', { since }, signal));
    } catch (error) {
      if (!(error instanceof ApiError && error.field === 'since')) throw error;
    }
  return json(request('cell/plan', texts, signal));
}

/** The cell with the robot at home, as binary glTF. */
export async function cellScene(key: string, signal: AbortSignal): Promise<ArrayBuffer> {
  return buffer(request(`cell/scenes/${key}`, undefined, signal));
}

export type CellExportFormat = Schemas['CellExportFormat'];

/** The motion of a program as a file, with its name. */
export async function cellExport(what: Schemas['CellExportRequest'], signal: AbortSignal): Promise<{ blob: Blob; name: string }> {
  const response = await request('cell/export', what, signal);
  const name = /filename="([^"]+)"/.exec(response.headers.get('content-disposition') ?? '')?.[1] ?? 'export';
  return { blob: await blob(Promise.resolve(response)), name };
}

/** Samples of a motion in a time range [s], as an Arrow stream with the chosen columns. */
export async function cellSamples(texts: CellTexts, [from_s, to_s]: readonly [number, number], columns: string[], rate_hz: number, signal: AbortSignal): Promise<ReadableStream<Uint8Array>> {
  const response = await request('cell/samples', { ...texts, from_s, to_s, columns, rate_hz, peaks: true }, signal);
  if (!response.body) throw new ConnectionError('the response of the server is empty');
  return response.body;
}

export type ControllerDocument = Schemas['ControllerDocument'];
export type HostDocument = Schemas['HostDocument'];

/** The simulated controller and its connected hosts. */
export async function controller(): Promise<ControllerDocument> {
  return json(request('controller'));
}

/** The robot of a host of the controller at this time. */
export async function hostOfController(number: number): Promise<HostDocument> {
  return json(request(`controller/hosts/${number}`));
}

/** Contents of a window of a motion. */
export async function cellWindow(key: string): Promise<ArrayBuffer> {
  return buffer(request(`cell/windows/${key}`));
}

/** Minimum and maximum values of all axes in windows of a plan. */
export async function cellOverview(plan: string, windows: number[]): Promise<Float64Array> {
  return unpack(await buffer(request('cell/overview', { plan, windows }))).numbers;
}

/** One page of 100 instructions of a plan. */
export async function cellInstructions(plan: string, page: number): Promise<Schemas['InstructionsPage']> {
  return json(request(`cell/plans/${plan}/instructions/${page}`));
}

/** The text of the cell file with new values of one station; comments are preserved. */
export async function setStation(text: string, station: string, change: StationChange, signal: AbortSignal): Promise<CellText> {
  return json(request('cell/station', { cell: text, station, ...change }, signal));
}

/** A change of the stations, bodies, arms and effectors of a cell. */
export type EntryChange = Omit<Schemas['EntryRequest'], 'cell' | 'heading_rad'> & { heading_rad?: number };

/** The text of the cell file with an added, duplicated or removed entry; comments are preserved. */
export async function changeEntry(text: string, change: EntryChange, signal: AbortSignal): Promise<Schemas['EntryDocument']> {
  return json(request('cell/entry', { cell: text, ...change }, signal));
}

// Mechanisms

export type MechanismSource = Schemas['MechanismSource'];
export type MechanismDocument = Schemas['MechanismDocument'];
export type OpenedDocument = Schemas['OpenedDocument'];
export type ConfigurationDocument = Schemas['ConfigurationDocument'];
export type DriveDocument = Schemas['DriveDocument'];
export type MobilityOfMechanism = Schemas['MobilityOfMechanism'];
export type SuggestDocument = Schemas['SuggestDocument'];
export type MotionsDocument = Schemas['MotionsDocument'];
export type BranchesDocument = Schemas['BranchesDocument'];
export type CatalogueEntry = Schemas['CatalogueEntry'];
export type PlacedDocument = Schemas['PlacedDocument'];
export type RedundantConstraint = Schemas['RedundantConstraintReport'];

/** The included mechanisms. */
export async function catalogue(): Promise<CatalogueEntry[]> {
  return json(request('catalogue'));
}

/** Address of the picture of an included mechanism. */
export const cataloguePicture = (name: string): string => `${ROOT}/catalogue/${encodeURIComponent(name)}/picture`;

/** The mechanism that the server was started with. */
export async function mechanismFile(): Promise<Schemas['MechanismFileDocument']> {
  return json(request('mechanism'));
}

/** Saves the text of the mechanism file; with `replaces`, only if the file on disk still has this version. */
export async function saveMechanism(text: string, replaces: string | null): Promise<Schemas['MechanismFileDocument']> {
  return json(request('mechanism', replaces === null ? { text } : { text, replaces }, undefined, 'PUT'));
}

/** A mechanism from the text of a file, closed near the given coordinates [m, rad]. */
export async function openMechanism(mechanism: MechanismSource, from: number[] | null, play_scale: number, signal: AbortSignal): Promise<OpenedDocument> {
  return json(request('mechanism/open', from ? { mechanism, from, play_scale } : { mechanism, play_scale }, signal));
}

/** Drives joints to values in the units of the file, from given coordinates [m, rad]. */
export async function driveMechanism(mechanism: MechanismSource, from: number[], to: Record<string, string>, play_scale: number): Promise<DriveDocument> {
  return json(request('mechanism/drive', { mechanism, from, to, play_scale }));
}

/** Moves a point of a link as near as possible to a position [m]; without a position, nothing moves. */
export async function reachMechanism(mechanism: MechanismSource, from: number[], { link, point_m }: { link: string; point_m: number[] }, wanted: { to_m: number[]; as_drawn: boolean } | null, play_scale: number): Promise<Schemas['ReachedDocument']> {
  return json(request('mechanism/reach', { mechanism, from, link, point_m, play_scale, ...wanted }));
}

export type MechanismExportFormat = Schemas['MechanismExportFormat'];

/** The motion of a joint as a file. */
export async function mechanismExport(what: Schemas['MechanismExportRequest'], signal: AbortSignal): Promise<Blob> {
  return blob(request('mechanism/export', what, signal));
}

/** A configuration with its poses at another play scale. */
export async function mechanismConfiguration(mechanism: MechanismSource, coordinates: number[], play_scale: number): Promise<ConfigurationDocument> {
  return json(request('mechanism/configuration', { mechanism, coordinates, play_scale }));
}

export async function mechanismMobility(mechanism: MechanismSource, coordinates: number[], signal: AbortSignal): Promise<MobilityOfMechanism> {
  return json(request('mechanism/mobility', { mechanism, coordinates }, signal));
}

/** The instantaneous motions in a configuration. */
export async function mechanismMotions(mechanism: MechanismSource, coordinates: number[]): Promise<MotionsDocument> {
  return json(request('mechanism/motions', { mechanism, coordinates }));
}

/** Closed configurations with the actuated joints at their values. */
export async function mechanismBranches(mechanism: MechanismSource, coordinates: number[], play_scale: number): Promise<BranchesDocument> {
  return json(request('mechanism/branches', { mechanism, coordinates, play_scale }));
}

/** Virtual joints that make a motion possible. */
export async function suggestVirtualJoints(mechanism: MechanismSource, signal: AbortSignal): Promise<SuggestDocument> {
  return json(request('mechanism/suggest', { mechanism }, signal));
}
