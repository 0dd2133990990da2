// State of the cell view: cell file and program under edit, their plan, and the current time.

import * as api from '../api/client';
import { ConnectionError, ApiError, type PlanDocument, type StationDocument } from '../api/client';
import { connection } from '../api/connection.svelte';
import { otherFile } from '../api/otherFile';
import { readDrafts, removeDraft, removeOlderDraft, storeDraft, type Draft } from '../lib/draft';
import { toCellHash, type CellLink, type CellTab } from '../lib/cellLink';
import { History } from '../lib/history';
import { keysOfPart, stationOfPart, type Part } from '../lib/parts';
import { CONTACT_FIELD, contactNoteLine, type ContactRequest } from './contactNote';
import { ControllerMonitor } from './controllerMonitor.svelte';
import { JogController } from './jogController.svelte';
import { TextChanges } from './textChanges.svelte';
import { UnknownPlan, Timeline } from './timeline.svelte';
import { ViewTools } from './viewTools.svelte';
import type { SceneView } from '../scene/standardViews';
import { download } from '../state/export';
import type { PicturedView } from '../state/picture';
import type { RecordedView } from '../state/recorder.svelte';

/** The 3D view, as far as other parts of the page use it. */
export interface CellSceneView extends PicturedView, RecordedView {
  showView(view: SceneView): void;
  cameraPose: { eye: number[]; target: number[] };
  /** Keys of all parts. */
  readonly parts: ReadonlySet<string>;
}

interface Texts {
  cell: string;
  program: string;
}

/** A cell file that was opened in this browser: the server has no file of it. */
interface OpenedCell {
  readonly name: string;
  readonly texts: Texts;
}

/** State that undo restores: the texts, the taught points of planes with too few points [m], by station, and the file of the texts. */
interface Work {
  texts: Texts;
  points: Record<string, number[][]>;
  /** `null` for the files of the server. */
  opened: OpenedCell | null;
}

/** Minimum number of points that define a plane. */
export const MIN_PLANE_POINTS = 3;
/** Maximum distance of a taught point from the plane of all points, for stations without a threshold of their own [m]. */
const DEFAULT_THRESHOLD = 1e-4;

/** Pause in typing after which the texts are planned [ms]. */
const TYPING_PAUSE_MS = 250;
/** Minimum duration of the time range of chart and plots [s]. */
export const MIN_RANGE_S = 0.05;
export const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5, 10] as const;

export class WorkcellSession {
  texts = $state.raw<Texts>({ cell: '', program: '' });
  /** The cell file that was opened in this browser; `null` for the files of the server. */
  opened = $state.raw<OpenedCell | null>(null);
  /** Files of the server: name of the cell file, `null` for the example, and the texts as last loaded or saved. */
  #server = $state.raw<{ file: string | null; saved: Texts }>({ file: null, saved: this.texts });
  /** The last downloaded texts of an opened cell. */
  #downloaded = $state.raw<{ of: OpenedCell; texts: Texts } | null>(null);
  /** Name of the cell file; `null` for the example. */
  file = $derived(this.opened ? this.opened.name : this.#server.file);
  /** The texts as last loaded, opened, saved or downloaded. */
  saved = $derived(this.opened === null ? this.#server.saved : this.#downloaded?.of === this.opened ? this.#downloaded.texts : this.opened.texts);
  plan = $state.raw<PlanDocument | null>(null);
  /** Reserved words of the program language. */
  keywords: readonly string[] = [];
  /** Names of the dialects of controller text. */
  dialects = $state.raw<readonly string[]>([]);
  /** The stations of the last valid cell; errors in their values can be fixed in the panel. */
  stations = $state.raw<StationDocument[]>([]);
  /** The bodies of the last valid cell. */
  bodies = $state.raw<PlanDocument['bodies']>([]);
  /** The cell with the robot at home, as glTF. */
  sceneFile = $state.raw<ArrayBuffer | null>(null);
  /** The motion of the plan, as far as it has been loaded. */
  readonly timeline = new Timeline((error) => this.failed(error instanceof UnknownPlan ? null : error, () => void this.replan(true)));
  /** Time range of chart and plots [s]; `null` for the whole motion. */
  range = $state.raw<[number, number] | null>(null);
  state = $state<'starting' | 'planning' | 'ready' | 'failed'>('starting');
  notice = $state<string | null>(null);
  /** Whether saving failed because the files have changed on disk; the user decides how to continue. */
  diskConflict = $state(false);
  /** Unsaved changes of an earlier visit: restored, or offered if the files have changed since. */
  draft = $state.raw<{ restored: boolean; draft: Draft } | null>(null);
  /** Texts and key of the displayed plan. */
  planned = $state.raw<{ texts: Texts; key: string } | null>(null);
  /** Whether the last requested plan has arrived. */
  #upToDate = $state(false);
  /** Pending changes of entries of the cell file. */
  readonly #changes = new TextChanges();
  /** Whether a number is being typed and not yet committed. */
  typing = $state(false);
  /** Whether the cell is valid, so that its robot can be jogged. */
  jogAvailable = $derived((this.plan?.robot ?? null) !== null);
  /** Taught points of stations with too few points for a plane [m]. */
  points = $state.raw<Record<string, number[][]>>({});
  /** The line that the editor is requested to show. */
  requestedLine = $state.raw<{ line: number; kind: 'program' | 'cell' } | null>(null);
  readonly jog = new JogController(this);
  readonly tools = new ViewTools();
  readonly controller = new ControllerMonitor();
  /** Corners of the box around the displayed cell [m]; `null` without one. */
  extent = $state.raw<[number[], number[]] | null>(null);
  /** The open text or list. */
  tab = $state<CellTab>('program');
  /** Number of the instruction that is open in the list of steps. */
  instruction = $state<number | null>(null);
  /** The 3D view, while there is one. */
  view: CellSceneView | null = null;
  /** The camera of the 3D view when it was last closed. */
  camera: { eye: number[]; target: number[] } | null = null;
  /** Current time [s]. */
  time = $state(0);
  playing = $state(false);
  loop = $state(true);
  speed = $state(1);
  selected = $state.raw<Part | null>(null);
  /** The selected station, or the station of the selected slot. */
  station = $derived(stationOfPart(this.selected, this.stations));
  /** Keys of the selected part and of all parts that belong to it. */
  highlighted = $derived(keysOfPart(this.selected, { stations: this.stations, bodies: this.bodies, robot: this.plan?.robot ?? null }));
  /** The pending request to teach a station in contact. */
  #contact = $state.raw<ContactRequest | null>(null);
  /** The pending request to teach in contact, while text and pose are those that were checked. */
  contact = $derived.by(() => {
    const { jog } = this;
    const request = this.#contact;
    if (!request || request.cell !== this.texts.cell) return null;
    return jog.positions?.every((value, k) => Math.abs(value - request.positions[k]!) < 1e-9) ? request : null;
  });
  /** The dragged station at its current pose. */
  draggedStation = $state.raw<StationDocument | null>(null);
  /** The displayed stations, with the dragged one at its current pose. */
  displayedStations = $derived(this.stations.map((one) => (one.name === this.draggedStation?.name ? this.draggedStation : one)));
  #hasPast = $state(false);
  canRedo = $state(false);
  /** Duration of the last planning request [ms]. */
  took_ms = $state(0);
  changed = $derived(this.texts.cell !== this.saved.cell || this.texts.program !== this.saved.program);
  duration = $derived(this.plan?.report?.duration_s ?? 0);
  /** Whether the displayed result may differ from that of the current inputs: they have changed, are changing, or the server is disconnected. */
  outdated = $derived(
    this.plan !== null &&
      (!this.#upToDate ||
        this.#changes.pending > 0 ||
        this.typing ||
        this.draggedStation !== null ||
        connection.state !== 'connected' ||
        this.texts.cell !== this.planned?.texts.cell ||
        this.texts.program !== this.planned?.texts.program),
  );
  /** State of the motion at the current time; `null` while it is loading. */
  motionState = $derived(this.timeline.stateAt(this.time));
  /** The step at the current time. */
  step = $derived(this.motionState?.step ?? null);
  /** The violations at the current time. */
  violations = $derived(this.timeline.violations(this.time));
  /** Whether the motion at the current time is still loading. */
  loading = $derived(this.duration > 0 && this.motionState === null);

  #history = new History<Work>({ texts: this.texts, points: {}, opened: null });
  #version: string | null = null;
  /** Key of the displayed 3D scene. */
  #scene: string | null = null;
  #identity = '';
  #timer: ReturnType<typeof setTimeout> | undefined;
  #abort: AbortController | null = null;
  #frame = 0;
  /** Called at the end of the range that is played once, or when it is paused. */
  #once: (() => void) | null = null;
  #last = 0;

  /** Loads the texts when the view is opened for the first time. */
  async start(): Promise<void> {
    if (this.state !== 'starting') return;
    try {
      const { file, identity, cell, program, version, keywords, dialects } = await api.cell();
      if (this.state !== 'starting') return;
      this.state = 'planning';
      this.#identity = identity;
      this.#version = version;
      this.keywords = keywords;
      this.dialects = dialects;
      this.texts = { cell, program };
      this.#server = { file, saved: this.texts };
      this.points = {};
      this.#history = new History(this.#work);
      this.#restoreDraft();
      this.#updateHistory();
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

  /** Reports an error. Connection errors are not reported: after reconnection the texts are planned again. */
  failed(error: unknown, again: () => void = () => undefined): void {
    if (error instanceof DOMException && error.name === 'AbortError') return;
    if (error instanceof ConnectionError) return;
    if (error === null) again();
    else this.notice = error instanceof Error ? error.message : String(error);
  }

  // Drafts

  /** Stores unsaved changes of the files of the server in the browser. */
  #store(): void {
    // The draft of the files of the server remains while another cell is open.
    if (this.#identity === '' || this.#version === null || this.opened !== null) return;
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
    this.#history.commit(this.#work);
    this.draft = { restored: true, draft };
  }

  /** Restores the offered draft; undo returns to the previous texts. */
  restoreDraft(): void {
    if (!this.draft) return;
    this.#takeDraft(this.draft.draft);
    removeOlderDraft(this.#identity);
    this.commit();
    this.#updateHistory();
  }

  /** Returns to the saved texts if the draft was restored; undo restores the draft. */
  discardDraft(): void {
    if (this.draft?.restored) {
      this.texts = this.saved;
      this.points = {};
      this.commit();
    }
    removeOlderDraft(this.#identity);
    this.draft = null;
  }

  /** Applies an edit; it is planned after a pause in typing. */
  edit(part: Partial<Texts>): void {
    this.texts = { ...this.texts, ...part };
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.commit(), TYPING_PAUSE_MS);
  }

  /** Completes an edit: adds it to the undo history and plans it. */
  commit(): void {
    clearTimeout(this.#timer);
    if (this.#history.commit(this.#work)) this.#updateHistory();
    this.#store();
    void this.replan();
  }

  get #work(): Work {
    const { texts, points, opened } = this;
    return { texts, points, opened };
  }

  /** Shows a line of a text in its editor. */
  showLine(line: number, kind: 'program' | 'cell' = 'program'): void {
    this.requestedLine = { line, kind };
  }

  #updateHistory(): void {
    this.#hasPast = this.#history.canUndo;
    this.canRedo = this.#history.canRedo;
  }

  /** Whether undo has an effect: on the history, or on a pending change. */
  get canUndo(): boolean {
    return this.#hasPast || this.#changes.pending > 0;
  }

  /** Cancels pending changes, or returns to the last step. */
  undo(): void {
    if (this.#changes.cancel()) {
      this.draggedStation = null;
      return;
    }
    this.#completeEdit();
    this.#restore(this.#history.undo());
  }

  /** Adds an edit in progress to the history. */
  #completeEdit(): void {
    if (this.texts.cell === this.#history.present.texts.cell && this.texts.program === this.#history.present.texts.program) return;
    clearTimeout(this.#timer);
    if (this.#history.commit(this.#work)) this.#updateHistory();
  }

  redo(): void {
    this.#restore(this.#history.redo());
  }

  #restore(work: Work | undefined): void {
    if (!work) return;
    if (work.opened !== this.opened) this.#leaveCell();
    this.texts = work.texts;
    this.points = work.points;
    this.opened = work.opened;
    this.#updateHistory();
    this.#store();
    void this.replan();
  }

  /** Plans the texts. With `whole`, the complete texts are sent, for a server that no longer has the last plan. */
  async replan(whole = false): Promise<void> {
    this.#abort?.abort();
    const abort = new AbortController();
    this.#abort = abort;
    this.state = 'planning';
    this.#upToDate = false;
    const start = performance.now();
    try {
      const { texts } = this;
      const plan = await api.plan(texts, whole ? null : this.planned, abort.signal);
      if (abort.signal.aborted) return;
      if (plan.report?.duration_s !== this.plan?.report?.duration_s) this.range = null;
      this.plan = plan;
      this.timeline.show(plan);
      this.planned = { texts, key: plan.key };
      this.#upToDate = true;
      // A removed input field does not report the end of typing.
      if (!(document.activeElement instanceof HTMLInputElement)) this.typing = false;
      if (plan.stations.length > 0) {
        this.stations = plan.stations;
        this.bodies = plan.bodies;
      }
      this.draggedStation = null;
      this.took_ms = performance.now() - start;
      if (this.time > this.duration) this.time = this.duration;
      this.timeline.prefetch(this.time, this.range);
      this.jog.refresh();
      // For an invalid cell, the last valid one stays visible.
      if (plan.scene !== null && plan.scene !== this.#scene) {
        this.sceneFile = await api.cellScene(plan.scene, abort.signal);
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
   * Writes new values of a station into the text of the cell, after all pending changes.
   *
   * A contact in the pose `taught_by` requires a confirmation. `taken` is called when the text has arrived, in the same undo step.
   */
  setStation(station: string, change: api.StationChange, taken: () => void = () => undefined): Promise<void> {
    this.#contact = null;
    this.#completeEdit();
    return this.#changes.add((signal) => this.#change(station, change, taken, signal));
  }

  /** Adds, duplicates or removes an entry of the cell file, and selects the new one. */
  changeEntry(change: api.EntryChange): Promise<void> {
    this.#completeEdit();
    return this.#changes.add(async (signal) => {
      try {
        let before: string;
        let cell: string;
        let name: string | null;
        do {
          before = this.texts.cell;
          ({ cell, name } = await api.changeEntry(before, change, signal));
        } while (this.texts.cell !== before);
        this.texts = { ...this.texts, cell };
        this.select(name === null ? null : { kind: change.list, name });
        this.commit();
      } catch (error) {
        if (error instanceof ConnectionError) this.notice = 'The cell was not changed: the server does not respond.';
        else this.failed(error);
      }
    });
  }

  /** Adds a station where the wafer of the effector is. */
  async addStation(): Promise<void> {
    const [station] = this.stations;
    const here = station && (await this.jog.queryFrom(station.name, 1))?.from_slot?.station_if_here;
    await this.changeEntry({ action: 'add', list: 'station', ...(here ? { position_m: here.position_m, heading_rad: here.heading_rad } : {}) });
  }

  /** Adds a body where the camera looks. */
  addBody(): Promise<void> {
    const { target } = this.view?.cameraPose ?? this.camera ?? { target: [0, 0, 0] };
    return this.changeEntry({ action: 'add', list: 'body', position_m: target.map((m) => Math.round(m * 1000) / 1000) });
  }

  async #change(station: string, change: api.StationChange, taken: () => void, signal: AbortSignal): Promise<void> {
    try {
      let before: string;
      let after: string;
      let contacts: string[][];
      // If the text was edited in the meantime, the change is applied to the new text.
      do {
        before = this.texts.cell;
        ({ cell: after, contacts } = await api.setStation(before, station, change, signal));
        // The comment of an earlier point is preserved.
        const { taught_by, ...values } = change;
        if (taught_by && contacts.length === 0 && !change.position_m) after = (await api.setStation(before, station, values, signal)).cell;
      } while (this.texts.cell !== before);
      this.texts = { ...this.texts, cell: after };
      taken();
      this.commit();
      if (contacts.length > 0) this.showLine(contactNoteLine(after, station), 'cell');
    } catch (error) {
      this.draggedStation = null;
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
    }
  }

  /** Adds a point of the plane of a station; three points define it. */
  async teachPoint(station: StationDocument, point: number[], by: api.TaughtBy): Promise<void> {
    await this.teachPlane(station, [...this.pointsOf(station), point], by);
  }

  /** Adds a clicked point [m] to the plane of the station that is taught by clicks; without a point, ends teaching. */
  async teachClicked(point: number[] | null): Promise<void> {
    const station = this.stations.find(({ name }) => name === this.tools.teaching);
    // The picture has single precision.
    if (station && point) await this.teachPlane(station, [...this.pointsOf(station), point.map((m) => Number(m.toFixed(6)))]);
    else this.tools.teaching = null;
  }

  /** Rejects the pending request to teach in contact. */
  cancelContact(): void {
    this.#contact = null;
  }

  /** All taught points of the plane of a station [m]. */
  pointsOf({ name, taught_m }: StationDocument): number[][] {
    return this.points[name] ?? taught_m;
  }

  async teachPlane({ name, plane, taught_m }: StationDocument, points: number[][], by?: api.TaughtBy): Promise<void> {
    const { [name]: _, ...others } = this.points;
    if (points.length >= MIN_PLANE_POINTS) {
      const threshold_m = plane ? plane.threshold_um / 1e6 : DEFAULT_THRESHOLD;
      const taken = () => (this.points = others);
      await this.setStation(name, { taught: { points_m: points, threshold_m }, ...(by ? { taught_by: by } : {}) }, taken);
      return;
    }
    // Too few points for a plane: they are kept in addition to an existing plane.
    const waiting = points.length > 0 || taught_m.length > 0 ? { ...this.points, [name]: points } : others;
    const taken = () => (this.points = waiting);
    if (by) await this.setStation(name, { taught_by: by }, taken);
    else {
      taken();
      this.commit();
    }
  }

  // Files

  /** Opens a cell file of this browser, with an empty program; undo returns to the previous texts. */
  async open(name: string, cell: string): Promise<void> {
    await this.#completeBefore(name);
    this.#store();
    this.#leaveCell();
    this.texts = { cell, program: '' };
    this.points = {};
    this.opened = { name, texts: this.texts };
    this.commit();
  }

  /** Opens a program of this browser in the current cell; undo returns to the previous program. */
  async openProgram(name: string, program: string): Promise<void> {
    await this.#completeBefore(name);
    this.texts = { ...this.texts, program };
    this.instruction = null;
    this.tab = 'program';
    this.commit();
  }

  /** Completes changes of the current texts before a file is opened. */
  async #completeBefore(name: string): Promise<void> {
    await this.start();
    if (this.state === 'starting') throw new Error(`${name} was not opened: the cell of the server is not loaded`);
    await this.#changes.finished;
    this.#completeEdit();
  }

  /** Resets what belongs to the files that are no longer shown. */
  #leaveCell(): void {
    this.pause();
    this.seek(0);
    this.range = null;
    this.selected = null;
    this.instruction = null;
    this.draft = null;
    this.diskConflict = false;
    this.notice = null;
    this.#contact = null;
    this.tools.leaveCell();
  }

  /** Downloads one of the texts of an opened cell. */
  download(kind: keyof Texts): void {
    const { opened, texts, saved } = this;
    if (!opened) return;
    const stem = opened.name.replace(/\.[^.]*$/, '') || 'cell';
    if (kind === 'cell') download(new Blob([texts.cell], { type: 'application/toml' }), `${stem}.toml`);
    else download(new Blob([texts.program], { type: 'text/plain' }), `${stem}.program`);
    this.#downloaded = { of: opened, texts: { ...saved, [kind]: texts[kind] } };
  }

  /** Saves both texts; files that have changed on disk are overwritten only with `replace`. Changed texts of an opened cell are downloaded. */
  async save(replace = false): Promise<void> {
    await this.#changes.finished;
    if (this.opened) {
      for (const kind of ['cell', 'program'] as const) if (this.texts[kind] !== this.saved[kind]) this.download(kind);
      return;
    }
    if (!this.changed && !replace) return;
    const { texts } = this;
    try {
      if (replace && (await this.#isOfOtherFile())) return;
      const { cell, program, version } = await api.saveCell(texts, replace ? null : this.#version);
      this.#version = version;
      this.#server = { ...this.#server, saved: { cell, program } };
      this.notice = null;
      this.draft = null;
      this.diskConflict = false;
      this.#store();
    } catch (error) {
      if (error instanceof ApiError && error.field === 'replaces') this.diskConflict = !(await this.#isOfOtherFile());
      else if (error instanceof ConnectionError) this.notice = 'Not saved: the server does not respond. The changes are stored in this browser; save again after reconnection.';
      else this.notice = `Not saved: ${error instanceof Error ? error.message : String(error)}`;
    }
  }

  /** The texts on disk and those of this page. */
  async compareWithDisk(): Promise<{ title: string; disk: string; here: string }[]> {
    const { cell, program } = await api.cell();
    return [
      { title: this.file ?? 'cell file', disk: cell, here: this.texts.cell },
      { title: 'Program', disk: program, here: this.texts.program },
    ];
  }

  /** Whether the server has another cell than the shown one, which is then reported. */
  async #isOfOtherFile(): Promise<boolean> {
    const other = await otherFile(this.file ?? 'the example cell', async () => {
      const { file, identity } = await api.cell();
      return { name: file ?? 'of the example cell', isSame: identity === this.#identity };
    });
    if (other !== null) Object.assign(this, { diskConflict: false, notice: other });
    return other !== null;
  }

  /** Shows the files of the server, loaded from disk again; undo returns to the previous texts. */
  async reload(): Promise<void> {
    try {
      const { cell, program, version } = await api.cell();
      this.#completeEdit();
      if (this.opened) {
        this.#leaveCell();
        this.points = {};
      }
      this.#version = version;
      this.diskConflict = false;
      this.draft = null;
      this.opened = null;
      this.texts = { cell, program };
      this.#server = { ...this.#server, saved: this.texts };
      this.commit();
    } catch (error) {
      if (error instanceof ConnectionError) this.notice = 'The files were not reloaded: the server does not respond.';
      else this.failed(error);
    }
  }

  /** Hides all parts but the selected one, or shows all parts again. */
  isolate(): void {
    if (this.tools.hidden.size > 0) this.tools.showAll();
    else if (this.selected !== null) this.tools.isolate(this.highlighted, this.view?.parts ?? []);
  }

  /** Keys of the selected parts that are drawn. */
  get #drawn(): string[] {
    const drawn = this.view?.parts;
    return [...this.highlighted].filter((key) => drawn?.has(key) ?? true);
  }

  /** Whether the selected part is hidden. */
  get isHidden(): boolean {
    return this.tools.isHidden(this.#drawn);
  }

  /** Hides the selected part, or shows it again. */
  toggleHidden(): void {
    if (this.selected !== null) this.tools.toggleHidden(this.#drawn);
  }

  select(part: Part | null): void {
    this.selected = part;
  }

  // Links

  get #name(): string {
    return this.file ?? 'example';
  }

  /** Fragment of a URL that opens this view. */
  get link(): string {
    const { time, tab, instruction, selected, range, tools } = this;
    return toCellHash({ cell: this.#name, time, tab, instruction, selected, range, play: tools.playScale, camera: this.view?.cameraPose ?? this.camera });
  }

  /** Takes over the state of a link, once the motion is planned. */
  openLink({ cell, time, tab, instruction, selected, range, play, camera }: CellLink): void {
    if (cell !== this.#name) this.notice = `This link was created with another cell, “${cell}”. Its time and selection may not apply to this cell.`;
    this.pause();
    this.tab = tab;
    this.instruction = instruction;
    this.selected = selected;
    this.range = this.#within(range);
    this.tools.playScale = play;
    this.seek(time);
    if (!camera) return;
    this.camera = camera;
    if (this.view) this.view.cameraPose = camera;
  }

  /** The part of a time range within the motion [s]; `null` if there is none. */
  #within(range: [number, number] | null): [number, number] | null {
    if (!range) return null;
    const [from, to] = [Math.max(range[0], 0), Math.min(range[1], this.duration)];
    return to - from > MIN_RANGE_S && to - from < this.duration ? [from, to] : null;
  }

  // Playback

  /** Plays the shown time range once; calls `done` at its end, or when the motion is paused. */
  playOnce(done: () => void): void {
    this.seek(this.range?.[0] ?? 0);
    this.#once = done;
    this.play();
  }

  seek(time: number): void {
    this.controller.shown = false;
    this.time = Math.min(Math.max(time, 0), this.duration);
    this.jog.release();
    if (!this.playing) this.jog.refresh();
  }

  toggle(): void {
    if (this.playing) this.pause();
    else this.play();
  }

  play(): void {
    if (this.playing || this.duration === 0) return;
    if (this.time >= this.duration) this.time = 0;
    this.controller.shown = false;
    this.jog.release();
    this.playing = true;
    this.#last = performance.now();
    this.#frame = requestAnimationFrame((now) => this.#tick(now));
  }

  pause(): void {
    if (!this.playing) return;
    this.playing = false;
    cancelAnimationFrame(this.#frame);
    this.jog.refresh();
    const once = this.#once;
    this.#once = null;
    once?.();
  }

  #tick(now: number): void {
    const passed = Math.min(Math.max(now - this.#last, 0), 250) / 1000;
    this.#last = now;
    let to = this.time + passed * this.speed;
    const end = this.range?.[1] ?? this.duration;
    if (this.#once && to >= end) {
      this.seek(end);
      this.pause();
      return;
    }
    if (to >= this.duration) {
      if (this.loop) to %= this.duration || 1;
      else {
        this.seek(this.duration);
        this.pause();
        return;
      }
    }
    // Playback waits for windows that are still loading.
    this.timeline.prefetch(to, null);
    if (this.timeline.stateAt(to)) this.time = to;
    this.#frame = requestAnimationFrame((next) => this.#tick(next));
  }
}

export const session = new WorkcellSession();
