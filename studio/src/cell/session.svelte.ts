// State of the cell view: cell file and program under edit, their plan, and what is shown of it.

import * as api from '../api/client';
import { ConnectionError, ApiError, type PlanDocument, type StationDocument } from '../api/client';
import { connection } from '../api/connection.svelte';
import { messageUnit } from '../api/lengthUnit';
import { otherFile } from '../api/otherFile';
import { DraftStore, type CellDraft } from '../lib/draft';
import type { CellTab } from '../lib/cellLink';
import { History } from '../lib/history';
import { CellChanges } from './cellChanges.svelte';
import { ControllerMonitor } from './controllerMonitor.svelte';
import { JogController } from './jogController.svelte';
import { PartSelection } from './partSelection.svelte';
import { Playback } from './playback.svelte';
import { Teaching } from './teaching.svelte';
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

/** Pause in typing after which the texts are planned [ms]. */
const TYPING_PAUSE_MS = 250;

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
  /** Duration of the motion [s]. */
  duration = $derived(this.plan?.report?.duration_s ?? 0);
  readonly playback: Playback = new Playback(this);
  state = $state<'starting' | 'planning' | 'ready' | 'failed'>('starting');
  notice = $state<string | null>(null);
  /** Whether saving failed because the files have changed on disk; the user decides how to continue. */
  diskConflict = $state(false);
  /** Unsaved changes of an earlier visit: restored, or offered if the files have changed since. */
  draft = $state.raw<{ restored: boolean; draft: CellDraft } | null>(null);
  /** Texts and key of the displayed plan. */
  planned = $state.raw<{ texts: Texts; key: string } | null>(null);
  /** Whether the last requested plan has arrived. */
  #upToDate = $state(false);
  /** Whether a number is being typed and not yet committed. */
  typing = $state(false);
  /** Whether the cell is valid, so that its robot can be jogged. */
  jogAvailable = $derived((this.plan?.robot ?? null) !== null);
  /** Whether the planned cell file has errors, so that nothing is known of the cell. */
  isInvalid = $derived(this.plan !== null && !this.jogAvailable);
  /** The line that the editor is requested to show. */
  requestedLine = $state.raw<{ line: number; kind: 'program' | 'cell' } | null>(null);
  readonly jog: JogController = new JogController(this);
  readonly tools = new ViewTools();
  readonly changes: CellChanges = new CellChanges(this);
  readonly teaching: Teaching = new Teaching(this);
  readonly controller: ControllerMonitor = new ControllerMonitor();
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
  readonly selection: PartSelection = new PartSelection(this);
  /** Stations that are being dragged or changed, with their new values, by name: until these are planned. */
  #changedStations = $state.raw<Readonly<Record<string, StationDocument>>>({});
  /** The displayed stations, with the values of changes that are not planned yet: a further change begins with these. */
  displayedStations = $derived(this.stations.map((one) => this.#changedStations[one.name] ?? one));
  #hasPast = $state(false);
  canRedo = $state(false);
  /** Duration of the last planning request [ms]. */
  took_ms = $state(0);
  changed = $derived(this.texts.cell !== this.saved.cell || this.texts.program !== this.saved.program);
  /** Whether the displayed result may differ from that of the current inputs: they have changed, are changing, or the server is disconnected. */
  outdated = $derived(
    this.plan !== null &&
      (!this.#upToDate ||
        this.changes.pending > 0 ||
        this.typing ||
        this.isStationChanged ||
        connection.state !== 'connected' ||
        this.texts.cell !== this.planned?.texts.cell ||
        this.texts.program !== this.planned?.texts.program),
  );
  /** State of the motion at the current time; `null` while it is loading. */
  motionState = $derived(this.timeline.stateAt(this.playback.time));
  /** The step at the current time. */
  step = $derived(this.motionState?.step ?? null);
  /** The violations at the current time. */
  violations = $derived(this.timeline.violations(this.playback.time));
  /** Whether the motion at the current time is still loading. */
  loading = $derived(this.duration > 0 && this.motionState === null);

  #history = new History<Work>({ texts: this.texts, points: {}, opened: null });
  #version: string | null = null;
  /** Key of the displayed 3D scene. */
  #scene: string | null = null;
  #identity = '';
  /** Drafts of the files of the server; `null` until these are loaded. */
  #drafts: DraftStore<CellDraft> | null = null;
  #timer: ReturnType<typeof setTimeout> | undefined;
  #abort: AbortController | null = null;

  /** Loads the texts when the view is opened for the first time. */
  async start(): Promise<void> {
    if (this.state !== 'starting') return;
    try {
      const { file, identity, cell, program, version, keywords, dialects } = await api.cell();
      if (this.state !== 'starting') return;
      this.state = 'planning';
      this.#identity = identity;
      this.#drafts = DraftStore.ofCell(identity);
      this.#version = version;
      this.keywords = keywords;
      this.dialects = dialects;
      this.texts = { cell, program };
      this.#server = { file, saved: this.texts };
      this.teaching.points = {};
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
    messageUnit.onChange(() => {
      if (this.plan) void this.replan();
    });
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
    if (!this.#drafts || this.#version === null || this.opened !== null) return;
    const { texts } = this;
    const { points } = this.teaching;
    if (this.changed || Object.keys(points).length > 0)
      this.#drafts.store({ ...texts, points, version: this.#version, stored_ms: Date.now() });
    else this.#drafts.remove();
  }

  #restoreDraft(): void {
    if (!this.#drafts) return;
    // A draft of another version of the files is offered, and not applied.
    if (this.#drafts.current?.version !== this.#version) this.#drafts.postpone();
    const { earlier } = this.#drafts;
    const current = this.#drafts.takeUp();
    if (current) this.#takeDraft(current);
    else if (earlier && (earlier.cell !== this.texts.cell || earlier.program !== this.texts.program)) this.draft = { restored: false, draft: earlier };
  }

  #takeDraft(draft: CellDraft): void {
    this.texts = { cell: draft.cell, program: draft.program };
    this.teaching.points = draft.points;
    this.#history.commit(this.#work);
    this.draft = { restored: true, draft };
  }

  /** Restores the offered draft; undo returns to the previous texts. */
  restoreDraft(): void {
    if (!this.draft) return;
    this.#takeDraft(this.draft.draft);
    this.#drafts?.removeEarlier();
    this.commit();
    this.#updateHistory();
  }

  /** Returns to the saved texts if the draft was restored; undo restores the draft. */
  discardDraft(): void {
    if (this.draft?.restored) {
      this.texts = this.saved;
      this.teaching.points = {};
      this.commit();
    }
    this.#drafts?.removeEarlier();
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
    const { texts, opened } = this;
    const { points } = this.teaching;
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

  /** Whether a displayed station has values that are not planned yet. */
  get isStationChanged(): boolean {
    return Object.keys(this.#changedStations).length > 0;
  }

  /** Shows a station with its new values before they are planned. */
  showChanged(station: StationDocument): void {
    this.#changedStations = { ...this.#changedStations, [station.name]: station };
  }

  /** Shows the stations as they were planned. */
  forgetChanged(): void {
    this.#changedStations = {};
  }

  /** Whether undo has an effect: on the history, or on a pending change. */
  get canUndo(): boolean {
    return this.#hasPast || this.changes.pending > 0;
  }

  /** Cancels pending changes, or returns to the last step. */
  undo(): void {
    if (this.changes.cancel()) {
      this.forgetChanged();
      return;
    }
    this.completeEdit();
    this.#restore(this.#history.undo());
  }

  /** Adds an edit in progress to the history. */
  completeEdit(): void {
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
    this.forgetChanged();
    this.texts = work.texts;
    this.teaching.points = work.points;
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
      if (plan.report?.duration_s !== this.plan?.report?.duration_s) this.playback.range = null;
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
      // Pending changes are planned next.
      if (this.changes.pending === 0) this.forgetChanged();
      this.took_ms = performance.now() - start;
      this.playback.time = Math.min(this.playback.time, this.duration);
      this.timeline.prefetch(this.playback.time, this.playback.range);
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

  // Files

  /** Opens a cell file of this browser with a program, by default an empty one; undo returns to the previous texts. */
  async open(name: string, cell: string, program = ''): Promise<void> {
    await this.#completeBefore(name);
    this.#store();
    this.#leaveCell();
    this.texts = { cell, program };
    this.teaching.points = {};
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
    await this.changes.finished;
    this.completeEdit();
  }

  /** Resets what belongs to the files that are no longer shown. */
  #leaveCell(): void {
    this.playback.pause();
    this.playback.seek(0);
    this.playback.range = null;
    this.selection.part = null;
    this.instruction = null;
    this.draft = null;
    this.diskConflict = false;
    this.notice = null;
    this.changes.cancelContact();
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
    await this.changes.finished;
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

  /** Shows the files of the server, loaded from disk again, unless this is aborted before; undo returns to the previous texts. */
  async reload(signal?: AbortSignal): Promise<void> {
    try {
      const { cell, program, version } = await api.cell();
      if (signal?.aborted) return;
      this.completeEdit();
      if (this.opened) {
        this.#leaveCell();
        this.teaching.points = {};
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

  // What plays

  /** Ends the display of a controller, and of a jogged pose. */
  showProgram(): void {
    this.controller.shown = false;
    this.jog.release();
  }

  /** Checks the pose at the time at which the motion rests. */
  rest(): void {
    this.jog.refresh();
  }
}

export const session = new WorkcellSession();
