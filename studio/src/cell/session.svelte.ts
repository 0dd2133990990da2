// What the cell's part of the page knows: two texts, what they come to, and the moment shown.

import * as api from '../api/client';
import { ConnectionError, ApiError, type PlanDocument, type StationDocument } from '../api/client';
import { connection } from '../api/connection.svelte';
import { readDrafts, removeDraft, removeOlderDraft, storeDraft, type Draft } from '../lib/draft';
import { History } from '../lib/history';
import { CONTACT_FIELD, contactNoteLine, type ContactRequest } from './contactNote';
import { JogController } from './jogController.svelte';
import { Forgotten, Timeline } from './timeline.svelte';
import type { CellView } from './cellRenderer';

interface Texts {
  cell: string;
  program: string;
}

/** What undo goes back to: the texts, and points that a plane cannot be laid through yet [m], by station. */
interface Work {
  texts: Texts;
  points: Record<string, number[][]>;
}

/** Fewer points make no plane. */
export const ENOUGH_POINTS = 3;
/** How far a taught point may lie from the plane of all, where the station says nothing [m]. */
const USUAL_THRESHOLD = 1e-4;

/** How long nobody may type before the texts are planned anew. */
const REST_MS = 250;
export const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5, 10] as const;

export class WorkcellSession {
  file = $state<string | null>(null);
  texts = $state.raw<Texts>({ cell: '', program: '' });
  saved = $state.raw<Texts>({ cell: '', program: '' });
  plan = $state.raw<PlanDocument | null>(null);
  /** The stations of the last cell that could be read: what is wrong with it can be mended here too. */
  stations = $state.raw<StationDocument[]>([]);
  /** The cell standing still, as glTF. */
  shape = $state.raw<ArrayBuffer | null>(null);
  /** The motion of the plan, as far as it has been fetched. */
  readonly timeline = new Timeline((error) => this.failed(error instanceof Forgotten ? null : error, () => void this.replan(true)));
  /** The stretch of time that bars and plots show [s]; all where there is none. */
  range = $state.raw<[number, number] | null>(null);
  state = $state<'starting' | 'planning' | 'ready' | 'failed'>('starting');
  notice = $state<string | null>(null);
  /** The files changed on the disk: what is here cannot be kept without a decision. */
  overtaken = $state(false);
  /** Unsaved changes of an earlier visit: restored already, or offered because the files are others by now. */
  draft = $state.raw<{ restored: boolean; draft: Draft } | null>(null);
  /** The texts that the plan on show was made of, and its key. */
  planned = $state.raw<{ texts: Texts; key: string } | null>(null);
  /** Whether the last plan that was asked for has arrived. */
  #answered = $state(false);
  /** Changes of stations whose text is not there yet. */
  #changing = $state(0);
  /** Whether a number is being typed that is not taken yet. */
  typing = $state(false);
  /** Whether the cell can be read, so that its robot can be moved. */
  movable = $derived((this.plan?.robot ?? null) !== null);
  /** Points taught of stations that have not enough for a plane [m]. */
  points = $state.raw<Record<string, number[][]>>({});
  /** A line that somebody wants to see. */
  sought = $state.raw<{ line: number; kind: 'program' | 'cell' } | null>(null);
  readonly jog = new JogController(this);
  /** Which text or list is open beside the picture. */
  tab = $state<'program' | 'steps' | 'parts' | 'cell'>('program');
  /** Shows a standard view, while there is a picture. */
  look: ((view: CellView) => void) | null = null;
  /** The camera of the picture when it was last closed. */
  camera: { eye: number[]; target: number[] } | null = null;
  /** The moment shown [s]. */
  time = $state(0);
  playing = $state(false);
  loop = $state(true);
  speed = $state(1);
  /** The part or station that is chosen. */
  chosen = $state<string | null>(null);
  /** The station that is chosen, by itself or by one of its slots. */
  station = $derived(this.stations.find(({ name }) => this.chosen === name || (this.chosen?.startsWith(`${name} `) ?? false)) ?? null);
  /** Names of all parts that belong to what is chosen. */
  marked = $derived.by((): ReadonlySet<string> => {
    const { chosen } = this;
    if (chosen === null) return new Set();
    const slots = this.stations.find(({ name }) => name === chosen)?.slots ?? 0;
    const named = Array.from({ length: slots }, (_, k) => `${chosen} ${k + 1}`);
    const robot = this.plan?.robot;
    const whole = robot?.name === chosen;
    for (const { name, links, effectors } of robot?.arms ?? []) {
      if (whole || name === chosen) named.push(...links);
      else if (effectors.includes(chosen)) named.push(...links.slice(-1));
    }
    if (whole) named.push('platform', ...robot!.axes.slice(0, 3).map(({ name }) => name));
    return new Set([chosen, ...named]);
  });
  /** A station that waits for the confirmation that it is taught in contact. */
  #contact = $state.raw<ContactRequest | null>(null);
  /** The same, as long as text and pose are those that were checked. */
  contact = $derived.by(() => {
    const { jog } = this;
    const asked = this.#contact;
    if (!asked || asked.cell !== this.texts.cell) return null;
    return jog.positions?.every((value, k) => Math.abs(value - asked.positions[k]!) < 1e-9) ? asked : null;
  });
  /** A station while it is dragged. */
  dragged = $state.raw<StationDocument | null>(null);
  /** The stations as they are shown: one may be under way. */
  shownStations = $derived(this.stations.map((one) => (one.name === this.dragged?.name ? this.dragged : one)));
  canUndo = $state(false);
  canRedo = $state(false);
  /** How long the last plan took, from the change to the answer [ms]. */
  took_ms = $state(0);
  changed = $derived(this.texts.cell !== this.saved.cell || this.texts.program !== this.saved.program);
  duration = $derived(this.plan?.report?.duration_s ?? 0);
  /** Whether the result on show is not that of all that stands on the page, checked by a server that is there. */
  outdated = $derived(
    this.plan !== null &&
      (!this.#answered ||
        this.#changing > 0 ||
        this.typing ||
        this.dragged !== null ||
        connection.state !== 'connected' ||
        this.texts.cell !== this.planned?.texts.cell ||
        this.texts.program !== this.planned?.texts.program),
  );
  /** What moves at the moment shown; none while it is fetched. */
  moment = $derived(this.timeline.moment(this.time));
  /** The step that runs at the moment shown. */
  step = $derived(this.moment?.step ?? null);
  /** What is broken at the moment shown. */
  broken = $derived(this.timeline.broken(this.time));
  /** Whether the moment shown is still fetched. */
  fetching = $derived(this.duration > 0 && this.moment === null);

  #history = new History<Work>({ texts: this.texts, points: {} });
  #version: string | null = null;
  /** Key of the picture of the cell. */
  #scene: string | null = null;
  #identity = '';
  /** The changes of stations that are under way, one after another. */
  #changes: Promise<void> = Promise.resolve();
  #timer: ReturnType<typeof setTimeout> | undefined;
  #abort: AbortController | null = null;
  #frame = 0;
  #last = 0;

  /** Fetches the texts at the first visit; later visits go on with what is there. */
  async start(): Promise<void> {
    if (this.state !== 'starting') return;
    try {
      const { file, identity, cell, program, version } = await api.cell();
      if (this.state !== 'starting') return;
      this.state = 'planning';
      this.file = file;
      this.#identity = identity;
      this.#version = version;
      this.texts = this.saved = { cell, program };
      this.points = {};
      this.#history = new History({ texts: this.texts, points: this.points });
      this.#restoreDraft();
      this.#steps();
      await this.replan();
    } catch (error) {
      this.failed(error);
    }
  }

  constructor() {
    connection.onReconnect(() => void (this.state === 'starting' ? this.start() : this.replan()));
    window.addEventListener('beforeunload', (event) => {
      this.#store();
      if (this.changed) event.preventDefault();
    });
    window.addEventListener('pagehide', () => this.#store());
  }

  /** Where there is no answer, the connection waits for the server's return, and the texts are planned then. */
  failed(error: unknown, again: () => void = () => undefined): void {
    if (error instanceof DOMException && error.name === 'AbortError') return;
    if (error instanceof ConnectionError) return;
    if (error === null) again();
    else this.notice = error instanceof Error ? error.message : String(error);
  }

  // Drafts

  /** Stores what is not saved in this browser. */
  #store(): void {
    if (this.#identity === '' || this.#version === null) return;
    const { texts, points } = this;
    if (this.changed || Object.keys(points).length > 0)
      storeDraft(this.#identity, { ...texts, points, version: this.#version, stored_ms: Date.now() });
    else removeDraft(this.#identity);
  }

  #restoreDraft(): void {
    const { current, older } = readDrafts(this.#identity, this.#version!);
    if (current) this.#takeDraft(current);
    else if (older && (older.cell !== this.texts.cell || older.program !== this.texts.program)) this.draft = { restored: false, draft: older };
  }

  #takeDraft(draft: Draft): void {
    this.texts = { cell: draft.cell, program: draft.program };
    this.points = draft.points;
    this.#history.commit({ texts: this.texts, points: this.points });
    this.draft = { restored: true, draft };
  }

  /** Takes the offered draft; undo goes back to the texts that were there. */
  restoreDraft(): void {
    if (!this.draft) return;
    this.#takeDraft(this.draft.draft);
    removeOlderDraft(this.#identity);
    this.settle();
    this.#steps();
  }

  /** Goes back to the files' texts, where the draft was restored; undo brings it back. */
  discardDraft(): void {
    if (this.draft?.restored) {
      this.texts = this.saved;
      this.points = {};
      this.settle();
    }
    removeOlderDraft(this.#identity);
    this.draft = null;
  }

  /** Takes what was typed; it is planned when typing rests. */
  type(part: Partial<Texts>): void {
    this.texts = { ...this.texts, ...part };
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.settle(), REST_MS);
  }

  /** A change is whole: it can be undone, and is planned. */
  settle(): void {
    clearTimeout(this.#timer);
    if (this.#history.commit({ texts: this.texts, points: this.points })) this.#steps();
    this.#store();
    void this.replan();
  }

  /** Shows a line of a text. */
  find(line: number, kind: 'program' | 'cell' = 'program'): void {
    this.sought = { line, kind };
  }

  #steps(): void {
    this.canUndo = this.#history.canUndo;
    this.canRedo = this.#history.canRedo;
  }

  undo(): void {
    this.#restore(this.#history.undo());
  }

  redo(): void {
    this.#restore(this.#history.redo());
  }

  #restore(work: Work | undefined): void {
    if (!work) return;
    this.texts = work.texts;
    this.points = work.points;
    this.#steps();
    this.#store();
    void this.replan();
  }

  /** Plans the texts; where the server has forgotten the last plan, that is not what they are told by. */
  async replan(whole = false): Promise<void> {
    this.#abort?.abort();
    const abort = new AbortController();
    this.#abort = abort;
    this.state = 'planning';
    this.#answered = false;
    const begun = performance.now();
    try {
      const { texts } = this;
      const plan = await api.plan(texts, whole ? null : this.planned, abort.signal);
      if (abort.signal.aborted) return;
      if (plan.report?.duration_s !== this.plan?.report?.duration_s) this.range = null;
      this.plan = plan;
      this.timeline.show(plan);
      this.planned = { texts, key: plan.key };
      this.#answered = true;
      // A field that has left the page no longer says that nobody types into it.
      if (!(document.activeElement instanceof HTMLInputElement)) this.typing = false;
      if (plan.stations.length > 0) this.stations = plan.stations;
      this.dragged = null;
      this.took_ms = performance.now() - begun;
      if (this.time > this.duration) this.time = this.duration;
      this.timeline.want(this.time, this.range);
      this.jog.renew();
      // Where the cell cannot be read, the last one that could stays in view.
      if (plan.scene !== null && plan.scene !== this.#scene) {
        this.shape = await api.cellScene(plan.scene, abort.signal);
        this.#scene = plan.scene;
      }
      if (abort.signal.aborted) return;
      this.state = 'ready';
    } catch (error) {
      if (abort.signal.aborted) return;
      this.state = 'failed';
      this.failed(error);
    }
  }

  /**
   * New values of a station, written into the text of the cell, after those that are under way.
   *
   * A contact in the pose `taught_by` needs a confirmation first; `taken` is called when the text is there, in the same step of undo.
   */
  setStation(station: string, change: api.StationChange, taken: () => void = () => undefined): Promise<void> {
    this.#contact = null;
    // A text that is being typed is whole now.
    if (this.texts.cell !== this.#history.present.texts.cell || this.texts.program !== this.#history.present.texts.program) {
      clearTimeout(this.#timer);
      if (this.#history.commit({ texts: this.texts, points: this.points })) this.#steps();
    }
    this.#changing += 1;
    this.#changes = this.#changes.then(() => this.#change(station, change, taken));
    return this.#changes;
  }

  async #change(station: string, change: api.StationChange, taken: () => void): Promise<void> {
    try {
      let before: string;
      let after: string;
      let touching: string[][];
      // A text that was typed in the meantime is changed instead of the earlier one.
      do {
        before = this.texts.cell;
        ({ cell: after, touching } = await api.setStation(before, station, change));
        // The note of an earlier point stays.
        const { taught_by, ...values } = change;
        if (taught_by && touching.length === 0 && !change.position_m) after = (await api.setStation(before, station, values)).cell;
      } while (this.texts.cell !== before);
      this.texts = { ...this.texts, cell: after };
      taken();
      this.settle();
      if (touching.length > 0) this.find(contactNoteLine(after, station), 'cell');
    } catch (error) {
      this.dragged = null;
      const by = change.taught_by;
      if (by && error instanceof ApiError && error.field === CONTACT_FIELD)
        this.#contact = {
          station,
          message: error.message,
          cell: this.texts.cell,
          positions: by.positions,
          confirm: () => {
            this.#contact = null;
            void this.setStation(station, { ...change, taught_by: { ...by, confirm_contact: true } }, taken);
          },
        };
      else if (error instanceof ConnectionError) this.notice = `${station} was not changed: the server does not respond.`;
      else this.failed(error);
    } finally {
      this.#changing -= 1;
    }
  }

  /** A point of a station's plane; from the third on they make it. */
  async teachPoint(station: StationDocument, point: number[], by: api.TaughtBy): Promise<void> {
    await this.teachPlane(station, [...this.pointsOf(station), point], by);
  }

  /** Does not teach in contact. */
  cancelContact(): void {
    this.#contact = null;
  }

  /** All points of a station's plane, those that wait for more among them [m]. */
  pointsOf({ name, taught_m }: StationDocument): number[][] {
    return this.points[name] ?? taught_m;
  }

  async teachPlane({ name, plane, taught_m }: StationDocument, points: number[][], by?: api.TaughtBy): Promise<void> {
    const { [name]: _, ...others } = this.points;
    if (points.length >= ENOUGH_POINTS) {
      const threshold_m = plane ? plane.threshold_um / 1e6 : USUAL_THRESHOLD;
      const taken = () => (this.points = others);
      await this.setStation(name, { taught: { points_m: points, threshold_m }, ...(by ? { taught_by: by } : {}) }, taken);
      return;
    }
    // Fewer than a plane needs: they wait beside a plane that there may be.
    const waiting = points.length > 0 || taught_m.length > 0 ? { ...this.points, [name]: points } : others;
    const taken = () => (this.points = waiting);
    if (by) await this.setStation(name, { taught_by: by }, taken);
    else {
      taken();
      this.settle();
    }
  }

  /** Saves both texts in their files; files that have changed on the disk meanwhile, only with `replace`. */
  async save(replace = false): Promise<void> {
    await this.#changes;
    if (!this.changed && !replace) return;
    const { texts } = this;
    try {
      const { cell, program, version } = await api.saveCell(texts, replace ? null : this.#version);
      this.#version = version;
      this.saved = { cell, program };
      this.notice = null;
      this.draft = null;
      this.overtaken = false;
      this.#store();
    } catch (error) {
      if (error instanceof ApiError && error.field === 'replaces') this.overtaken = true;
      else if (error instanceof ConnectionError) this.notice = 'Not saved: the server does not respond. The changes are stored in this browser; save again after reconnection.';
      else this.notice = `Not saved: ${error instanceof Error ? error.message : String(error)}`;
    }
  }

  /** Takes the files as they are on the disk; what was here can be had back by undo. */
  async reload(): Promise<void> {
    try {
      const { cell, program, version } = await api.cell();
      this.#version = version;
      this.overtaken = false;
      this.draft = null;
      this.saved = this.texts = { cell, program };
      this.settle();
    } catch (error) {
      if (error instanceof ConnectionError) this.notice = 'The files were not reloaded: the server does not respond.';
      else this.failed(error);
    }
  }

  choose(name: string | null): void {
    this.chosen = name;
  }

  // Time

  seek(time: number): void {
    this.time = Math.min(Math.max(time, 0), this.duration);
    this.jog.release();
    if (!this.playing) this.jog.renew();
  }

  toggle(): void {
    if (this.playing) this.pause();
    else this.play();
  }

  play(): void {
    if (this.playing || this.duration === 0) return;
    if (this.time >= this.duration) this.time = 0;
    this.jog.release();
    this.playing = true;
    this.#last = performance.now();
    this.#frame = requestAnimationFrame((now) => this.#tick(now));
  }

  pause(): void {
    if (!this.playing) return;
    this.playing = false;
    cancelAnimationFrame(this.#frame);
    this.jog.renew();
  }

  #tick(now: number): void {
    const passed = Math.min(Math.max(now - this.#last, 0), 250) / 1000;
    this.#last = now;
    let to = this.time + passed * this.speed;
    if (to >= this.duration) {
      if (this.loop) to %= this.duration || 1;
      else {
        this.seek(this.duration);
        this.pause();
        return;
      }
    }
    // It waits for what is not there yet.
    this.timeline.want(to, null);
    if (this.timeline.moment(to)) this.time = to;
    this.#frame = requestAnimationFrame((next) => this.#tick(next));
  }
}

export const session = new WorkcellSession();
