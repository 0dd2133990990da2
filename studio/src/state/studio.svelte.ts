// What the page knows and shows. Panels read it and call its methods; nothing else changes it.

import * as api from '../api/client';
import { connection } from '../api/connection.svelte';
import { ConnectionError, ApiError, type PoseDocument, type RobotDocument } from '../api/client';
import {
  initialDocument,
  VIRTUALIZATIONS,
  type Command,
  type Document,
  type HeightKind,
  type Metric,
  type Motion,
  type Shown,
  type Solver,
  type Virtualization,
} from '../lib/document';
import { History } from '../lib/history';
import { fingerprint, fromHash, toHash, type RobotIdentity, type View } from '../lib/link';
import { withinTilt } from '../lib/limits';
import { load, save } from '../lib/settings';
import { degrees, millimetres, type LengthUnit } from '../lib/units';
import type { Theme } from '../scene/palette';
import { probe } from './probe';
import { Player } from './player.svelte';
import { Study } from './study.svelte';

export type ThemeChoice = 'system' | Theme;

const LINK = 'link';

/** Decimals of mm and degrees: as people read them, and so that a pose on a limit stays on it. */
const TIDY = 6;
const EXACT = 12;

/** A pose as a command. */
function asCommand(kind: Command['kind'], height_kind: HeightKind, pose: PoseDocument, decimals: number): Command {
  const round = (value: number) => Number(value.toFixed(decimals));
  if (kind === 'rods') return { kind, rods_mm: pose.rods_m.map((q) => round(millimetres(q))) as [number, number, number] };
  const center = pose.models[0]?.answer?.pose.origin_m[2];
  const height_m = height_kind === 'center' && center !== undefined ? center : pose.axis_height_m;
  const height_mm = round(millimetres(height_m));
  const { yaw_rad, pitch_rad, about_x_rad, about_y_rad } = pose.tilt;
  return kind === 'tilt'
    ? { kind, yaw_deg: round(degrees(yaw_rad)), pitch_deg: round(degrees(pitch_rad)), height_mm, height_kind }
    : { kind, about_x_deg: round(degrees(about_x_rad)), about_y_deg: round(degrees(about_y_rad)), height_mm, height_kind };
}

/** A pose as a command of the kind that was told. */
function inTermsOf(told: Command, pose: PoseDocument, decimals: number): Command {
  const command = asCommand(told.kind, told.kind === 'rods' ? 'axis' : told.height_kind, pose, decimals);
  if (told.kind !== 'tilt' || command.kind !== 'tilt') return command;
  // Level leans nowhere; and a lean toward one side is a negative one toward the other.
  if (command.pitch_deg === 0) return { ...command, yaw_deg: told.yaw_deg };
  if (told.pitch_deg >= 0) return command;
  return { ...command, pitch_deg: -command.pitch_deg, yaw_deg: command.yaw_deg + (command.yaw_deg > 0 ? -180 : 180) };
}

export class Studio {
  robot = $state.raw<RobotDocument | null>(null);
  pose = $state.raw<PoseDocument | null>(null);
  document = $state.raw<Document>(initialDocument(500));
  /** Why the robot stays where it is, or another thing to tell. */
  notice = $state<string | null>(null);
  /** The robot that the link was made with, where it is not this one. */
  foreignRobot = $state<string | null>(null);
  canUndo = $state(false);
  canRedo = $state(false);
  unit = $state<LengthUnit>('mm');
  themeChoice = $state<ThemeChoice>('system');
  systemTheme = $state<Theme>('light');
  theme = $derived<Theme>(this.themeChoice === 'system' ? this.systemTheme : this.themeChoice);
  /** What the link said about the view; the viewer takes it when it is there. */
  linkedView: View | null = null;
  /** Says where the eye is, once there is a viewer. */
  readView: (() => View) | null = null;
  readonly study = new Study();
  readonly player = new Player(this.study, { show: (command) => this.showSample(command), stopped: () => this.rememberLink() });

  #history = new History<Document>(this.document);
  #good: Command = this.document.command;
  #wanted: { command: api.ApiCommand; jog: boolean } | null = null;
  #asking: Promise<void> | null = null;
  #steps = Promise.resolve();
  #linkTimer: ReturnType<typeof setTimeout> | undefined;

  async start(): Promise<void> {
    const dark = window.matchMedia('(prefers-color-scheme: dark)');
    this.systemTheme = dark.matches ? 'dark' : 'light';
    dark.addEventListener('change', () => (this.systemTheme = dark.matches ? 'dark' : 'light'));
    this.unit = load('unit', 'mm', (value) => value === 'mm' || value === 'inch');
    this.themeChoice = load('theme', 'system', (value) => ['system', 'light', 'dark'].includes(value as string));
    // Not the address of now: the page may have written its own in the meantime.
    window.addEventListener('hashchange', ({ newURL }) => this.#follow(new URL(newURL).hash));
    connection.onReconnect(() => void this.#connect());
    await this.#connect();
  }

  async #connect(): Promise<void> {
    try {
      const robot = await api.robot();
      const first = this.robot === null;
      this.robot = robot;
      if (first) this.#follow(window.location.hash || load(this.#linkKey, '', (value) => typeof value === 'string'));
      else {
        this.#ask(this.document.command, true);
        if (this.document.motion && this.study.state !== 'ready') this.loadStudy();
      }
    } catch (error) {
      this.#failed(error);
    }
  }

  #failed(error: unknown): void {
    // The connection waits for the server's return, and asks again then.
    if (error instanceof ConnectionError) return;
    if (error instanceof ApiError) this.notice = error.message;
    else throw error;
  }

  /** How links name this robot: by all that the server tells of it, but for its own version and shapes. */
  get #mark(): RobotIdentity | null {
    if (!this.robot) return null;
    const { name, limbs, limits, working_height_m } = this.robot;
    return { name, print: fingerprint([limbs, limits, working_height_m]) };
  }

  /** What is kept of one robot means nothing to another. */
  get #linkKey(): string {
    return `${LINK}.${this.#mark?.print}`;
  }

  // The document

  /** Takes over what a link says. */
  #follow(hash: string): void {
    clearTimeout(this.#linkTimer);
    const usual = this.robot ? initialDocument(millimetres(this.robot.working_height_m), degrees(this.robot.limits.tilt_max_rad)) : initialDocument(500);
    const { robot, document, view, sample } = fromHash(hash, usual);
    const own = this.#mark;
    this.foreignRobot = robot && own && robot.print !== own.print ? robot.name : null;
    this.document = document;
    this.#good = document.command;
    this.#history = new History(document);
    this.#tellSteps();
    this.linkedView = view;
    this.#ask(document.command, true);
    this.player.sample = null;
    if (document.motion) void this.loadStudy().then(() => sample !== null && this.player.seek(sample));
    else this.study.clear();
  }

  #tellSteps(): void {
    this.canUndo = this.#history.canUndo;
    this.canRedo = this.#history.canRedo;
  }

  /** Ends a change: all since the last is one step of undo. */
  commit(): Promise<void> {
    return this.#then(() => {
      if (this.#history.commit(this.document)) this.#tellSteps();
      this.rememberLink();
    });
  }

  undo(): Promise<void> {
    return this.#then(() => this.#restore(this.#history.undo()));
  }

  redo(): Promise<void> {
    return this.#then(() => this.#restore(this.#history.redo()));
  }

  /** Steps of undo are made and taken in the order they were asked for, each when the robot has come to rest. */
  #then(step: () => void): Promise<void> {
    this.#steps = this.#steps.then(() => this.settled()).then(step);
    return this.#steps;
  }

  #restore(document: Document | undefined): void {
    if (!document) return;
    const before = this.document;
    this.document = document;
    this.notice = null;
    this.player.detach();
    this.#tellSteps();
    this.#ask(document.command, true);
    this.#renewStudy(before);
    this.rememberLink();
  }

  #change(part: Partial<Document>): void {
    const before = this.document;
    this.document = { ...before, ...part };
    this.#renewStudy(before);
    void this.commit();
  }

  #renewStudy(before: Document): void {
    const now = this.document;
    const key = (one: Document) => JSON.stringify([one.motion, one.model, one.solver, one.metric]);
    if (key(before) === key(now)) return;
    if (now.motion) void this.loadStudy();
    else {
      this.player.detach();
      this.study.clear();
    }
  }

  setModel(model: Virtualization): void {
    this.#change({ model });
    this.#again();
  }

  setSolver(solver: Solver): void {
    this.#change({ solver });
    this.#again();
  }

  setMetric(metric: Metric): void {
    this.#change({ metric });
    this.#again();
  }

  setShown(part: Partial<Shown>): void {
    this.#change({ shown: { ...this.document.shown, ...part } });
  }

  /** While a slider moves; `commit` ends it. */
  exaggerate(exaggeration: number): void {
    this.document = { ...this.document, exaggeration };
  }

  setMotion(motion: Motion | null, also: Partial<Document> = {}): void {
    this.player.detach();
    this.#change({ motion, ...also });
    this.#again();
  }

  // Moving

  /** What the robot is told at the moment, be it by hand or by the motion. */
  get command(): Command {
    return this.document.command;
  }

  /** Moves the robot by hand: along the limit of tilt, and up to any other limit that is in the way. */
  jog(wanted: Command): void {
    if (this.player.sample !== null) this.player.detach();
    const command = this.robot ? withinTilt(wanted, degrees(this.robot.limits.tilt_max_rad)) : wanted;
    this.document = { ...this.document, command };
    this.#ask(command, true);
  }

  /** Shows a sample of the motion. */
  showSample(command: api.ApiCommand): void {
    this.#wanted = { command, jog: false };
    this.#asking ??= this.#work();
  }

  /** Resolves when the last thing asked has been answered. */
  async settled(): Promise<void> {
    while (this.#asking) await this.#asking;
  }

  #again(): void {
    if (this.player.sample === null) this.#ask(this.document.command, true);
    else this.player.seek(this.player.sample);
  }

  #ask(command: Command, jog: boolean): void {
    this.#wanted = { command: api.toApiCommand(command), jog };
    this.#asking ??= this.#work();
  }

  /** Asks for what is wanted, always the newest, one request at a time. */
  async #work(): Promise<void> {
    probe.settled = false;
    try {
      while (this.#wanted) {
        const { command, jog } = this.#wanted;
        const told = this.document.command;
        this.#wanted = null;
        const { model, solver, metric } = this.document;
        const order = [model, ...VIRTUALIZATIONS.filter((name) => name !== model)];
        const models = order.map((name) => api.modelChoice(name, solver, metric));
        try {
          const answer = await api.pose(command, models, jog ? (this.pose?.rods_m ?? null) : null);
          const says = (limits: typeof answer.stopped_by) => limits.map(({ message }) => message).join('; ');
          if (jog && answer.limits_broken.length > 0) {
            this.#stay(told, says(answer.limits_broken));
            // At the very first there is no good pose to stay at: better one beyond the limits than none.
            if (!this.pose) this.pose = answer;
            continue;
          }
          this.pose = answer;
          if (!jog) continue;
          this.#good = told;
          if (answer.stopped_by.length > 0) {
            this.#good = inTermsOf(told, answer, EXACT);
            if (this.document.command === told) this.document = { ...this.document, command: this.#good };
            this.notice = `Stopped at a limit: ${says(answer.stopped_by)}.`;
          } else if (!this.#wanted) this.notice = null;
        } catch (error) {
          if (error instanceof ApiError && jog) this.#stay(told, error.message);
          else this.#failed(error);
        }
      }
    } finally {
      this.#asking = null;
      probe.settled = true;
    }
  }

  #stay(told: Command, why: string): void {
    this.notice = why;
    if (this.document.command !== told) return;
    this.document = { ...this.document, command: this.#good };
    // The panel that asked goes on in its own terms.
    const command = this.commandAs(told.kind);
    if (command) this.document = { ...this.document, command };
  }

  /** Where the robot is, as a command of the kind wanted: what a panel starts from. */
  commandAs(kind: Command['kind'], height_kind: HeightKind = 'axis'): Command | null {
    const { pose } = this;
    if (!pose) return null;
    if (kind === this.document.command.kind && this.player.sample === null) {
      const { command } = this.document;
      if (command.kind === 'rods' || command.height_kind === height_kind) return command;
    }
    return asCommand(kind, height_kind, pose, TIDY);
  }

  // Motion

  async loadStudy(): Promise<void> {
    const { motion, model, solver, metric } = this.document;
    if (!motion) return;
    try {
      await this.study.load(motion, api.modelChoice(model, solver, metric));
    } catch (error) {
      this.#failed(error);
    }
  }

  // The link and the settings

  get link(): string {
    const { document } = this;
    return toHash({ robot: this.#mark, document, view: this.readView?.() ?? null, sample: this.player.sample });
  }

  rememberLink(): void {
    clearTimeout(this.#linkTimer);
    this.#linkTimer = setTimeout(() => {
      const { link } = this;
      window.history.replaceState(null, '', link);
      save(this.#linkKey, link);
    }, 250);
  }

  setUnit(unit: LengthUnit): void {
    this.unit = unit;
    save('unit', unit);
  }

  setTheme(theme: ThemeChoice): void {
    this.themeChoice = theme;
    save('theme', theme);
  }
}

export const studio = new Studio();
