// State of the robot view. Panels read it and change it by its methods only.

import * as api from '../api/client';
import { connection } from '../api/connection.svelte';
import { messageUnit } from '../api/lengthUnit';
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
import { initialScale } from '../lib/playScale';
import { fromCellHash } from '../lib/cellLink';
import { fromMechanismHash } from '../lib/mechanismLink';
import { fingerprint, fromHash, toHash, type RobotIdentity, type View } from '../lib/link';
import { withinTilt } from '../lib/limits';
import { asCommand, asCommandLike, DISPLAY_DECIMALS, EXACT_DECIMALS } from '../lib/poseCommand';
import { robotKey } from '../lib/robotKey';
import { load, save } from '../lib/settings';
import { degrees, millimetres, type LengthUnit } from '../lib/units';
import type { Theme } from '../scene/palette';
import { finerDecimals, sceneUnits } from '../scene/robotSize';
import { Comparison, MOST_COMPARED } from './comparison.svelte';
import { layout } from './layout.svelte';
import { plotLayout } from './plotLayout.svelte';
import { probe } from './probe';
import { Player } from './player.svelte';
import { printing } from './printing.svelte';
import { RobotFile } from './robotFile.svelte';
import { ServerRobot } from './serverRobot';
import { Study } from './study.svelte';

/** How the robot moves to a command beyond its limits: in a straight line up to the first one, or along them. */
type Jog = 'stop' | 'slide';

export type ThemeChoice = 'system' | Theme;

const LINK = 'link';

export class Studio {
  /** Whether the last pose was requested without an answer. */
  #unanswered = $state(false);
  robot = $state.raw<RobotDocument | null>(null);
  pose = $state.raw<PoseDocument | null>(null);
  document = $state.raw<Document>(initialDocument(500));
  /** A message for the user, for example why the robot did not move. */
  notice = $state<string | null>(null);
  /** Name of the robot that the link was created with, if it is another one. */
  foreignRobot = $state<string | null>(null);
  canUndo = $state(false);
  canRedo = $state(false);
  unit = $state<LengthUnit>('mm');
  /** Decimals of lengths in addition to those of a robot of usual size. */
  finer = $derived(this.robot ? finerDecimals(this.robot.limbs) : 0);
  themeChoice = $state<ThemeChoice>('system');
  systemTheme = $state<Theme>('light');
  theme = $derived<Theme>(printing.active ? 'light' : this.themeChoice === 'system' ? this.systemTheme : this.themeChoice);
  /** Whether the pose may differ from that of the fields: the server does not answer. */
  outdated = $derived(connection.state === 'disconnected' || this.#unanswered);
  /** The camera of the link, until the 3D view has taken it over. */
  linkedView: View | null = null;
  /** Returns the camera of the 3D view, once there is one. */
  readView: (() => View | null) | null = null;
  readonly study = new Study();
  readonly comparison = new Comparison();
  readonly file = new RobotFile({ opened: (robot) => this.#showRobot(robot), committed: () => this.commit() });
  readonly player = new Player(this.study, { show: (command) => this.showSample(command), stopped: () => this.rememberLink() });

  readonly #serverRobot = new ServerRobot((robot) => void this.#showServerRobot(robot));
  #history = new History<Document>(this.document);
  #lastValid: Command = this.document.command;
  /** Whether the play scale is still to be chosen for the robot. */
  #fitsScale = false;
  #pending: { command: api.ApiCommand; jog: Jog | null } | null = null;
  #request: Promise<void> | null = null;
  #steps = Promise.resolve();
  #linkTimer: ReturnType<typeof setTimeout> | undefined;

  async start(): Promise<void> {
    const dark = window.matchMedia('(prefers-color-scheme: dark)');
    this.systemTheme = dark.matches ? 'dark' : 'light';
    dark.addEventListener('change', () => (this.systemTheme = dark.matches ? 'dark' : 'light'));
    this.unit = load('unit', 'mm', (value) => value === 'mm' || value === 'inch');
    messageUnit.set(this.unit);
    messageUnit.onChange(() => {
      if (this.robot && this.player.sample === null) this.#requestPose(this.document.command);
    });
    this.themeChoice = load('theme', 'system', (value) => ['system', 'light', 'dark'].includes(value as string));
    // The URL of the event, not the current one: the page may have changed it in the meantime.
    window.addEventListener('hashchange', ({ newURL }) => this.#openLink(new URL(newURL).hash));
    connection.onReconnect(() => void this.#connect());
    this.file.drafts.offer();
    await this.#connect();
  }

  async #connect(): Promise<void> {
    try {
      const robot = await api.robot();
      const first = this.robot === null;
      layout.controller = robot.controller;
      if (robot.controller) layout.chosenPart ??= 'cell';
      const isOther = this.#serverRobot.isOther(robot);
      // An edited robot remains.
      if (isOther && this.file.text === null) return await this.#showServerRobot(robot);
      if (this.file.source === null) this.robot = robot;
      if (first) this.#openLink(window.location.hash || load(this.#linkKey, '', (value) => typeof value === 'string'));
      else {
        this.#requestPose(this.document.command);
        if (this.document.motion && this.study.state !== 'ready') this.loadStudy();
      }
    } catch (error) {
      this.#failed(error);
    }
  }

  #failed(error: unknown): void {
    // After reconnection the requests are repeated.
    if (error instanceof ConnectionError) return;
    if (error instanceof ApiError) this.notice = error.message;
    else throw error;
  }

  /** Identity of this robot in links: name, and fingerprint of geometry and limits. */
  get #identity(): RobotIdentity | null {
    if (!this.robot) return null;
    const { name, limbs, limits, working_height_m } = this.robot;
    return { name, print: fingerprint([limbs, limits, working_height_m]) };
  }

  /** Key of the stored link; each robot has its own. */
  get #linkKey(): string {
    return `${LINK}.${this.#identity?.print}`;
  }

  // The document

  /** Takes over the contents of a link. */
  #openLink(hash: string): void {
    clearTimeout(this.#linkTimer);
    const cellLink = fromCellHash(hash);
    if (cellLink) {
      layout.cellLink = cellLink;
      if (this.robot?.cell) layout.setPart('cell');
      hash = load(this.#linkKey, '', (value) => typeof value === 'string');
    }
    const mechanismLink = fromMechanismHash(hash);
    if (mechanismLink) {
      layout.mechanismLink = mechanismLink;
      layout.setPart('mechanism');
      hash = load(this.#linkKey, '', (value) => typeof value === 'string');
    }
    const empty = this.robot ? initialDocument(millimetres(this.robot.working_height_m), degrees(this.robot.limits.tilt_max_rad)) : initialDocument(500);
    const initial = { ...empty, robotFile: this.document.robotFile };
    const { robot, document, view, sample } = fromHash(hash, initial);
    const own = this.#identity;
    this.foreignRobot = robot && own && robot.print !== own.print ? robot.name : null;
    this.document = document;
    this.#fitsScale = !/[#&]play=/.test(hash);
    this.#lastValid = document.command;
    this.#history = new History(document);
    this.#updateHistory();
    this.linkedView = view;
    this.#requestPose(document.command);
    this.player.sample = null;
    if (document.motion) void this.loadStudy().then(() => sample !== null && this.player.seek(sample));
    else this.study.clear();
  }

  #updateHistory(): void {
    this.canUndo = this.#history.canUndo;
    this.canRedo = this.#history.canRedo;
  }

  /** Completes a change: all changes since the last call are one undo step. */
  commit(): Promise<void> {
    return this.#enqueueStep(() => {
      // A text with errors describes no robot, and is a step all the same.
      if (this.document.robotFile !== null) this.document = { ...this.document, robotFile: this.file.work };
      if (this.#history.commit(this.document)) this.#updateHistory();
      this.rememberLink();
    });
  }

  undo(): Promise<void> {
    return this.#enqueueStep(() => {
      // Changes that wait for the server are no step yet.
      return this.file.cancelChanges() ? undefined : this.#restore(this.#history.undo());
    });
  }

  redo(): Promise<void> {
    return this.#enqueueStep(() => this.#restore(this.#history.redo()));
  }

  /** Undo steps are processed in order, each after all pending requests. */
  #enqueueStep(step: () => void | Promise<void>): Promise<void> {
    this.#steps = this.#steps.then(() => this.file.settled()).then(() => this.settled()).then(step);
    return this.#steps;
  }

  async #restore(document: Document | undefined): Promise<void> {
    if (!document) return;
    const before = this.document;
    this.document = document;
    this.notice = null;
    this.player.detach();
    this.#updateHistory();
    if (document.robotFile !== null) {
      this.file.restore(document.robotFile);
      // The limits of the robot that was shown do not hold for the restored pose.
      await this.file.settled();
    }
    this.#requestPose(this.document.command);
    this.#updateStudy(before);
    this.rememberLink();
  }

  /** Shows the robot of an edited text, at the nearest pose within its limits. */
  #showRobot(robot: RobotDocument): void {
    const { work } = this.file;
    const isOther = this.document.robotFile !== null && this.document.robotFile.opened !== work?.opened;
    // Another robot has other lengths: its pose is that of a start with its file.
    const command = isOther ? initialDocument(millimetres(robot.working_height_m), degrees(robot.limits.tilt_max_rad)).command : this.document.command;
    if (isOther) this.#fitsScale = true;
    if (this.document.robotFile === null) {
      // The loaded text is no change.
      this.document = { ...this.document, robotFile: work };
      this.#history.replace(this.document);
    } else this.document = { ...this.document, robotFile: work, command };
    this.#takeRobot(robot);
  }

  /** Shows a robot at the nearest pose within its limits, and its motion. */
  #takeRobot(robot: RobotDocument): void {
    const before = { print: this.#identity?.print, robot: JSON.stringify(this.robot) };
    this.robot = robot;
    if (before.robot === JSON.stringify(robot)) return;
    if (this.player.sample === null) this.#requestPose(this.document.command, 'slide');
    // Clearances do not change a motion.
    if (this.document.motion && before.print !== this.#identity?.print) void this.loadStudy().then(() => this.player.sample !== null && this.player.seek(this.player.sample));
  }

  /** Shows the robot of the server, which another page has saved; unsaved changes and a robot that was opened here remain. */
  async #showServerRobot(robot: RobotDocument): Promise<void> {
    const { file } = this;
    if (!this.robot || file.openedText !== null || robotKey(robot) === robotKey(this.robot)) return;
    if (file.changed) {
      this.notice = 'The robot of the server has changed. The unsaved changes of this page remain: saving asks before they replace the file.';
      return;
    }
    this.comparison.forget();
    if (file.text === null) this.#takeRobot(robot);
    else await file.reload();
    await this.settled();
    this.notice = ['The robot of the server has changed: the view shows the new one.', this.notice].filter(Boolean).join(' ');
    this.rememberLink();
  }

  #change(part: Partial<Document>): void {
    const before = this.document;
    this.document = { ...before, ...part };
    this.#updateStudy(before);
    void this.commit();
  }

  #updateStudy(before: Document): void {
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
    this.#recompute();
  }

  setSolver(solver: Solver): void {
    this.#change({ solver });
    this.#recompute();
  }

  setMetric(metric: Metric): void {
    this.#change({ metric });
    this.#recompute();
  }

  setShown(part: Partial<Shown>): void {
    this.#change({ shown: { ...this.document.shown, ...part } });
  }

  /** Sets the play scale while a slider moves; `commit` completes the change. */
  exaggerate(exaggeration: number): void {
    this.document = { ...this.document, exaggeration };
  }

  setMotion(motion: Motion | null, also: Partial<Document> = {}): void {
    this.player.detach();
    this.#change({ motion, ...also });
    this.#recompute();
  }

  // Jogging

  /** The current command. */
  get command(): Command {
    return this.document.command;
  }

  /** Jogs the robot: tilts about x and y and single rods move along the limits, other commands up to the first one. */
  jog(target: Command): void {
    if (this.player.sample !== null) this.player.detach();
    const command = this.robot ? withinTilt(target, degrees(this.robot.limits.tilt_max_rad)) : target;
    this.document = { ...this.document, command };
    this.#requestPose(command, command.kind === 'rods' ? 'slide' : 'stop');
  }

  /** Displays a sample of the motion. */
  showSample(command: api.ApiCommand): void {
    this.#pending = { command, jog: null };
    this.#request ??= this.#processRequests();
  }

  /** Resolves when all pending requests have been answered. */
  async settled(): Promise<void> {
    while (this.#request) await this.#request;
  }

  #recompute(): void {
    if (this.player.sample === null) this.#requestPose(this.document.command);
    else this.player.seek(this.player.sample);
  }

  #requestPose(command: Command, jog: Jog = 'stop'): void {
    this.#pending = { command: api.toApiCommand(command), jog };
    this.#request ??= this.#processRequests();
  }

  /** Requests the pending poses, one request at a time; only the newest pending one is kept. */
  async #processRequests(): Promise<void> {
    probe.settled = false;
    try {
      while (this.#pending) {
        const { command, jog } = this.#pending;
        const original = this.document.command;
        this.#pending = null;
        const { model, solver, metric } = this.document;
        const order = [model, ...VIRTUALIZATIONS.filter((name) => name !== model)];
        const models = order.map((name) => api.modelChoice(name, solver, metric));
        try {
          const atLimits = jog === 'slide' ? { slide: true as const } : jog === 'stop' ? { stop: this.pose?.rods_m ?? null } : { show: true as const };
          const answer = await api.pose(this.file.source, command, models, atLimits);
          const messages = (limits: typeof answer.stopped_by) => limits.map(({ message }) => message).join('; ');
          this.#unanswered = false;
          if (jog && answer.limits_broken.length > 0) {
            this.#revert(original, messages(answer.limits_broken));
            // Without a previous valid pose, the pose beyond the limits is displayed.
            if (!this.pose) this.pose = answer;
            continue;
          }
          this.pose = answer;
          if (this.#fitsScale) this.#fitScale(answer);
          if (!jog) continue;
          this.#lastValid = original;
          if (answer.stopped_by.length > 0) {
            this.#lastValid = asCommandLike(original, answer, EXACT_DECIMALS);
            if (this.document.command === original) this.document = { ...this.document, command: this.#lastValid };
            this.notice = jog === 'slide' ? `Held by a limit: ${messages(answer.stopped_by)}. Shown is the nearest pose within the limits.` : `Stopped at a limit: ${messages(answer.stopped_by)}.`;
          } else if (!this.#pending) this.notice = null;
        } catch (error) {
          this.#unanswered = error instanceof ConnectionError;
          if (error instanceof ApiError && jog) this.#revert(original, error.message);
          else this.#failed(error);
        }
      }
    } finally {
      this.#request = null;
      probe.settled = true;
      // The poses are those of the robot that the server has at present.
      if (this.file.source === null) this.#serverRobot.compare();
    }
  }

  /** Sets the play scale of a robot that was opened: its balls stay in their bearings. */
  #fitScale({ models }: PoseDocument): void {
    this.#fitsScale = false;
    const answer = models.find(({ model }) => model.virtualization === this.document.model)?.answer;
    if (!answer || !this.robot) return;
    const displacements = this.robot.limbs.map(({ socket_m }, k) => Math.hypot(answer.sockets_m[k]![0]! - socket_m[0]!, answer.sockets_m[k]![1]! - socket_m[1]!));
    const exaggeration = initialScale(sceneUnits(this.robot.limbs) * Math.max(...displacements));
    if (exaggeration === this.document.exaggeration) return;
    // No step of its own: a robot that is being opened becomes a step with it.
    const isCommitted = JSON.stringify(this.#history.present) === JSON.stringify(this.document);
    this.document = { ...this.document, exaggeration };
    if (isCommitted) this.#history.replace(this.document);
  }

  #revert(rejected: Command, why: string): void {
    this.notice = why;
    if (this.document.command !== rejected) return;
    this.document = { ...this.document, command: this.#lastValid };
    // The command keeps the kind that the panel uses.
    const command = this.commandAs(rejected.kind);
    if (command) this.document = { ...this.document, command };
  }

  /** The current pose as a command of a given kind. */
  commandAs(kind: Command['kind'], height_kind: HeightKind = 'axis'): Command | null {
    const { pose } = this;
    if (!pose) return null;
    if (kind === this.document.command.kind && this.player.sample === null) {
      const { command } = this.document;
      if (command.kind === 'rods' || command.height_kind === height_kind) return command;
    }
    return asCommand(kind, height_kind, pose, DISPLAY_DECIMALS);
  }

  // Motion

  async loadStudy(): Promise<void> {
    const { motion, model, solver, metric } = this.document;
    if (!motion) return;
    try {
      plotLayout.reference = null;
      await this.study.load(this.file.source, motion, api.modelChoice(model, solver, metric));
      await this.loadComparison();
    } catch (error) {
      this.#failed(error);
    }
  }

  /** Loads the studies of the models that are plotted in addition to the selected one. */
  async loadComparison(): Promise<void> {
    const { motion, model, solver, metric } = this.document;
    const models = plotLayout.models.filter((one) => one !== model);
    const tooMany = models.length > 0 && this.study.total > MOST_COMPARED;
    if (tooMany) this.notice = `The motion has ${this.study.total} samples; models are compared over up to ${MOST_COMPARED}.`;
    try {
      await this.comparison.load(this.file.source, motion, tooMany ? [] : models, (one) => api.modelChoice(one, solver, metric));
    } catch (error) {
      this.#failed(error);
    }
  }

  // The link and the settings

  get link(): string {
    const { document } = this;
    return toHash({ robot: this.#identity, document, view: this.readView?.() ?? null, sample: this.player.sample });
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
    messageUnit.set(unit);
  }

  setTheme(theme: ThemeChoice): void {
    this.themeChoice = theme;
    save('theme', theme);
  }
}

export const studio = new Studio();
