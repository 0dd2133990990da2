// State of the view of mechanisms: the text, its mechanism, the configuration, and the analyses of that configuration.

import * as api from '../api/client';
import { ConnectionError, type ConfigurationDocument, type MechanismDocument, type MechanismSource, type OpenedDocument } from '../api/client';
import { connection } from '../api/connection.svelte';
import { otherFile } from '../api/otherFile';
import { History } from '../lib/history';
import type { CameraPose } from '../lib/hashParts';
import type { MechanismLink, MechanismTab } from '../lib/mechanismLink';
import { KINDS, rememberFile } from '../lib/recentFiles';
import { fileSizeProblem, sizeProblem } from '../lib/requestSize';
import { shownNumber } from '../lib/shownNumber';
import { withFileUnit } from '../lib/units';
import { textOf } from '../lib/textFile';
import { readMechanismDraft, removeMechanismDraft, storeMechanismDraft, type MechanismDraft } from './draft';
import type { PicturedView } from '../state/picture';
import type { RecordedView } from '../state/recorder.svelte';

/** Pause in typing after which a text is read [ms]. */
const TYPING_PAUSE_MS = 350;
/** Pause in a motion after which the mobility is computed [ms]. */
const SETTLED_MS = 150;

/** Remedy for a model that is too large. */
const LARGER_MODEL = 'Use `jointplay import` for a larger model.';

/** The edited text, and what belongs to it. */
interface Work {
  /** Name of the file or entry. */
  name: string;
  text: string;
  /** Values of parameters in place of those of the text. */
  parameters: Record<string, number>;
  /** Whether the text is that of the file of the server. */
  ofServer: boolean;
  /** The text as it was opened or saved. */
  saved: string;
}

/** The model that a text was converted from: a second file may close its loops. */
interface Model {
  name: string;
  text: string;
}

/** An analysis of one configuration, or why there is none. */
export interface Analysis<T> {
  of: ConfigurationDocument;
  result: T | null;
  problem: string | null;
}

/** A point of a link that is moved by hand. */
export interface MovedPoint {
  link: string;
  /** In the frame of the link [m]. */
  point_m: number[];
  /** Wanted position [m]; `null` if none was entered. */
  to_m: number[] | null;
  /** Position without exaggerated play [m], in one configuration. */
  position_m: number[] | null;
  of: ConfigurationDocument | null;
  /** How far the wanted position is, and what keeps the point there. */
  message: string | null;
}

export type Selection = NonNullable<MechanismLink['selected']>;

/** The 3D view, as far as other parts of the page use it. */
export interface MechanismSceneView extends PicturedView, RecordedView {
  cameraPose: CameraPose;
}

const EMPTY: Work = { name: '', text: '', parameters: {}, ofServer: false, saved: '' };

/** A point of a selected part that can be moved [m, in the frame of its link]: at a joint, or at the end of a link; `null` for the base. */
function movingPoint(document: MechanismDocument, { kind, name }: Selection): { link: string; point_m: number[] } | null {
  if (kind === 'link') {
    const k = document.links.findIndex((link) => link.name === name);
    return k > 0 ? { link: name, point_m: document.links[k]!.bars[0]?.to_m ?? [0, 0, 0] } : null;
  }
  const virtual = document.virtual_joints.find((one) => one.name === name);
  const joint = kind === 'virtual' ? virtual && document.joints[virtual.joint] : document.joints.find((one) => one.name === name);
  const side = joint?.links.findIndex((k) => k > 0) ?? -1;
  return joint && side >= 0 ? { link: document.links[joint.links[side]!]!.name, point_m: joint.frames[side]!.origin_m } : null;
}

class MechanismSession {
  tab = $state<MechanismTab>('catalogue');
  work = $state.raw<Work>(EMPTY);
  /** The answer to the last text. */
  opened = $state.raw<OpenedDocument | null>(null);
  /** The last mechanism without errors. */
  document = $state.raw<MechanismDocument | null>(null);
  configuration = $state.raw<ConfigurationDocument | null>(null);
  /** Poses of the links at the play scale, once they differ from those of the configuration. */
  poses = $state.raw<ConfigurationDocument['poses'] | null>(null);
  /** The 3D view, while there is one. */
  view: MechanismSceneView | null = null;
  /** A camera that the view is still to take over: that of a link, or of the view when it was last closed. */
  camera = $state.raw<CameraPose | null>(null);
  /** Whether catalogue and mechanism of the server are loaded. */
  started = $state(false);
  /** Number of texts shown; the camera is placed again for each. */
  shown = $state(0);
  entries = $state.raw<api.CatalogueEntry[]>([]);
  playScale = $state(1);
  selected = $state.raw<Selection | null>(null);
  point = $state.raw<MovedPoint | null>(null);
  /** Index of the redundant constraint whose joints are highlighted. */
  redundant = $state<number | null>(null);
  /** Why the last motion stopped, or what it met. */
  stopped = $state<string | null>(null);
  met = $state.raw<string[]>([]);
  /** Values of driven coordinates at singular configurations that were met, by name. */
  singularValues = $state.raw<Record<string, number[]>>({});
  /** Errors by coordinate: values that cannot be commanded. */
  refused = $state.raw<Record<string, string>>({});
  notice = $state<string | null>(null);
  /** A file that another view shows, or of which this view shows a part. */
  otherView = $state.raw<{ kind: 'cell' | 'program' | 'three_rods'; name: string; text: string } | null>(null);
  diskConflict = $state(false);
  /** Unsaved text of an earlier visit, which is offered. */
  draft = $state.raw<MechanismDraft | null>(null);
  moving = $state(false);
  reading = $state(false);
  canUndo = $state(false);
  canRedo = $state(false);
  mobility = $state.raw<Analysis<api.MobilityOfMechanism> | null>(null);
  motions = $state.raw<Analysis<api.MotionsDocument> | null>(null);
  modes = $state.raw<Analysis<api.BranchesDocument> | null>(null);
  /** Virtual joints for a text; they do not depend on the configuration. */
  suggestion = $state.raw<{ of: string; result: api.SuggestDocument | null; problem: string | null } | null>(null);
  /** The running analysis, for its button. */
  computing = $state<'motions' | 'modes' | 'suggestion' | null>(null);
  /** The animated instantaneous motion. */
  animated = $state<number | null>(null);
  #typing = $state(false);
  changed = $derived(this.work.text !== this.work.saved || Object.keys(this.work.parameters).length > 0);
  diagnostics = $derived(this.opened?.diagnostics ?? []);
  /** Whether mechanism and configuration may differ from those of the text. */
  outdated = $derived(this.document !== null && (this.reading || this.#typing || this.diagnostics.length > 0 || connection.state === 'disconnected'));
  /** Whether an analysis is that of the shown configuration. */
  current = (analysis: Analysis<unknown> | null): boolean => analysis !== null && analysis.of === this.configuration && !this.outdated && !this.moving;

  #model: Model | null = null;
  /** Whether the stored draft is that of this page. */
  #hasStored = false;
  #version: string | null = null;
  #started = false;
  #history = new History<Work>(EMPTY);
  #timer: ReturnType<typeof setTimeout> | undefined;
  #settle: ReturnType<typeof setTimeout> | undefined;
  #abort: AbortController | null = null;
  #mobilityAbort: AbortController | null = null;
  /** Wanted values of driven coordinates that were not sent yet. */
  #wanted: Record<string, string> = {};
  /** Wanted position of the point that was not sent yet. */
  #wantedPosition: { to_m: number[]; as_drawn: boolean } | null = null;
  #scaling = false;
  /** Play scale of the poses. */
  #posesScale = 1;
  /** Play scale of the assembly modes. */
  #modesScale = 1;

  constructor() {
    connection.onReconnect(() => {
      if (!this.#started) return;
      if (this.entries.length === 0) void this.#loadCatalogue();
      if (this.work.text !== '') void this.#read(this.#here);
    });
    window.addEventListener('beforeunload', (event) => {
      this.#store();
      if (this.changed) event.preventDefault();
    });
    window.addEventListener('pagehide', () => this.#store());
  }

  /** Why there is no configuration. */
  get withoutConfiguration(): string {
    return this.document ? 'The loops are not closed.' : 'No mechanism is open.';
  }

  /** The mechanism of requests. */
  get source(): MechanismSource {
    return { text: this.work.text, parameters: this.work.parameters };
  }

  failed(error: unknown): void {
    if (error instanceof DOMException && error.name === 'AbortError') return;
    // Disconnection is shown in the header, and requests are repeated.
    if (error instanceof ConnectionError) return;
    this.notice = error instanceof Error ? error.message : String(error);
  }

  /** Opens the mechanism of the server, if it has one. */
  async start(ofServer: boolean): Promise<void> {
    if (this.#started) return;
    this.#started = true;
    await Promise.all([this.#loadCatalogue(), ofServer ? this.reload() : undefined]);
    const draft = readMechanismDraft();
    if (draft && draft.text !== this.work.text) this.draft = draft;
    this.started = true;
  }

  // Drafts

  /** Stores an unsaved text in the browser. */
  #store(): void {
    const { name, text, saved, ofServer } = this.work;
    if (text !== saved) storeMechanismDraft({ name, text, saved, ofServer, stored_ms: Date.now() });
    // The draft of an earlier visit remains until it is restored or discarded.
    else if (this.#hasStored) removeMechanismDraft();
    this.#hasStored = text !== saved;
  }

  /** Restores the offered text; undo returns to the previous one. */
  async restoreDraft(): Promise<void> {
    const { draft } = this;
    if (!draft) return;
    this.draft = null;
    // Another file may have the same name: only changes of the very text of the server are saved into its file.
    const ofServer = draft.ofServer && this.work.ofServer && this.work.name === draft.name && this.work.saved === draft.saved;
    this.#model = null;
    this.work = { name: draft.name, text: draft.text, parameters: {}, ofServer, saved: ofServer ? this.work.saved : draft.saved };
    this.#commitWork();
    this.#store();
    this.selected = null;
    this.point = null;
    await this.#read(null);
    this.shown += 1;
    this.tab = this.diagnostics.length > 0 ? 'text' : 'tree';
  }

  /** Removes the offered text. */
  discardDraft(): void {
    this.draft = null;
    removeMechanismDraft();
  }

  async #loadCatalogue(): Promise<void> {
    try {
      this.entries = await api.catalogue();
    } catch (error) {
      this.failed(error);
    }
  }

  /** Opens the mechanism of the server again. */
  async reload(): Promise<void> {
    this.diskConflict = false;
    try {
      const { name, text, loops, writable, version } = await api.mechanismFile();
      // The next save compares the file on disk with the version of the shown text.
      if (await this.open(name, text, loops ?? null, writable)) this.#version = version;
    } catch (error) {
      if (error instanceof ConnectionError) this.#started = false;
      this.failed(error);
    }
  }

  // Opening

  /** Opens a text; the previous one is restored by undo. Returns whether the text is open, with or without errors in it. */
  async open(name: string, text: string, loops: string | null = null, ofServer = false): Promise<boolean> {
    this.#abort?.abort();
    const abort = new AbortController();
    this.#abort = abort;
    this.notice = null;
    this.otherView = null;
    this.playScale = 1;
    this.reading = true;
    try {
      const source = loops === null ? { text } : { text, loops };
      const large = sizeProblem(name, source);
      if (large) {
        this.notice = `${large} ${LARGER_MODEL}`;
        return false;
      }
      const opened = await api.openMechanism(source, null, 1, abort.signal);
      if (abort.signal.aborted) return false;
      const { kind, diagnostics, mechanism } = opened;
      if (!mechanism && diagnostics.length === 0) {
        this.notice = `${name}: ${opened.note ?? ''}`;
        if (kind === 'cell' || kind === 'program') this.otherView = { kind, name, text };
        return false;
      }
      if (loops !== null && diagnostics.some(({ in_loops }) => in_loops)) {
        this.notice = `The file of loops has errors: ${diagnostics.map(({ line, message }) => `line ${line}: ${message}`).join('; ')}`;
        return false;
      }
      this.#model = kind === 'model' ? { name, text } : null;
      const title = kind === 'model' || kind === 'three_rods' ? name.replace(/\.\w+$/, '') + '.toml' : name;
      this.work = { name: title, text: opened.text, parameters: {}, ofServer, saved: opened.text };
      this.#commitWork();
      this.notice = opened.note ?? null;
      if (kind === 'three_rods') this.otherView = { kind, name, text };
      this.selected = null;
      this.#take(opened, true, 1);
      this.tab = diagnostics.length > 0 ? 'text' : 'tree';
      return true;
    } catch (error) {
      this.failed(error);
      return false;
    } finally {
      if (this.#abort === abort) this.reading = false;
    }
  }

  /** Adds an opened text to the undo history; the first one has no predecessor. */
  #commitWork(): void {
    if (this.#history.present.text === '') this.#history = new History(this.work);
    else this.#history.commit(this.work);
    this.#updateHistory();
  }

  /** Opens files that were chosen or dropped: a file, or a model with the file that closes its loops. */
  async openFiles(files: readonly File[]): Promise<void> {
    const large = files.map(fileSizeProblem).find((problem) => problem !== null);
    if (large) {
      this.notice = `${large} ${LARGER_MODEL}`;
      return;
    }
    if (files.length > 2) {
      this.notice = 'Open one file, or a model with the file that closes its loops.';
      return;
    }
    try {
      const texts = await Promise.all(files.map(async (file) => ({ name: file.name, text: await textOf(file) })));
      const isLoops = ({ name, text }: Model) => /\.ya?ml$/i.test(name) || /^\s*kind\s*=\s*["']loops["']/m.test(text);
      const loops = texts.find(isLoops);
      const other = texts.find((one) => one !== loops);
      if (other) {
        const isOpen = await this.open(other.name, other.text, loops?.text ?? null);
        const kind = KINDS.find((one) => one === this.opened?.kind);
        // A model of two files is not remembered: its loops are in the other file.
        if (isOpen && kind && !loops) rememberFile({ ...other, kind, opened_ms: Date.now() });
      }
      else if (loops && this.#model) await this.open(this.#model.name, this.#model.text, loops.text);
      else if (loops) this.notice = `${loops.name} closes the loops of a model: open the model first, or both together.`;
    } catch (error) {
      this.failed(error);
    }
  }

  /** Takes over the answer to a text. */
  #take(opened: OpenedDocument, fresh: boolean, scale: number): void {
    this.opened = opened;
    const { mechanism } = opened;
    if (fresh || mechanism) {
      this.document = mechanism ?? null;
      this.#setConfiguration(mechanism?.configuration ?? null, scale);
      this.stopped = null;
      this.met = [];
      this.refused = {};
      this.singularValues = {};
      this.redundant = null;
      this.animated = null;
      if (fresh) {
        this.#wanted = {};
        this.point = null;
      }
    }
    if (fresh) this.shown += 1;
    this.#settled();
  }

  // The text

  edit(text: string): void {
    this.work = { ...this.work, text };
    this.#typing = true;
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => void this.commit(), TYPING_PAUSE_MS);
  }

  /** Completes an edit: adds it to the undo history and reads the text. */
  async commit(): Promise<void> {
    clearTimeout(this.#timer);
    this.#typing = false;
    if (this.#history.commit(this.work)) this.#updateHistory();
    this.#store();
    await this.#read(this.#here);
  }

  /** Sets parameters and play scale, and closes the loops near given coordinates, or near the guess of the file. */
  async arrange(parameters: Record<string, number>, coordinates: number[] | null, playScale: number): Promise<void> {
    this.work = { ...this.work, parameters };
    this.playScale = playScale;
    this.commitParameters();
    await this.#read(coordinates);
  }

  /** Coordinates of the shown configuration. */
  get #here(): number[] | null {
    return this.configuration?.coordinates ?? null;
  }

  /** Reads the text again, near given coordinates or from its guess. */
  async #read(from: number[] | null): Promise<void> {
    this.#abort?.abort();
    const abort = new AbortController();
    this.#abort = abort;
    this.reading = true;
    try {
      const { playScale } = this;
      const opened = await api.openMechanism(this.source, from, playScale, abort.signal);
      if (abort.signal.aborted) return;
      this.#take(opened, false, playScale);
      this.reading = false;
      if (this.#isWanted && !this.moving) void this.#move();
    } catch (error) {
      // Without a connection, the state stays outdated until the text is read again.
      if (this.#abort === abort && !(error instanceof ConnectionError)) this.reading = false;
      this.failed(error);
    }
  }

  #updateHistory(): void {
    this.canUndo = this.#history.canUndo;
    this.canRedo = this.#history.canRedo;
  }

  undo(): void {
    if (this.#typing) void this.commit();
    this.#restore(this.#history.undo());
  }

  redo(): void {
    this.#restore(this.#history.redo());
  }

  #restore(work: Work | undefined): void {
    if (!work) return;
    // Another file has another configuration.
    const near = work.name === this.work.name;
    this.work = near ? { ...work, saved: this.work.saved } : work;
    this.#updateHistory();
    void this.#read(near ? this.#here : null).then(() => {
      if (!near) this.shown += 1;
    });
  }

  /** Sets a parameter; `null` restores the value of the file. */
  setParameter(name: string, value: number | null): void {
    const { [name]: _, ...others } = this.work.parameters;
    this.work = { ...this.work, parameters: value === null ? others : { ...others, [name]: value } };
    this.#updateHistory();
    void this.#read(this.#here);
  }

  /** Adds the parameters to the undo history, at the end of a drag of a slider. */
  commitParameters(): void {
    if (this.#history.commit(this.work)) this.#updateHistory();
  }

  /** Saves the text to the file of the server. */
  async save(overwrite = false): Promise<void> {
    if (!this.work.ofServer) return this.download();
    const { text } = this.work;
    try {
      if (overwrite && (await this.#isOfOtherFile())) return;
      const { version } = await api.saveMechanism(text, overwrite ? null : this.#version);
      this.#version = version;
      this.diskConflict = false;
      if (this.work.ofServer) this.work = { ...this.work, saved: text };
      this.#store();
    } catch (error) {
      if (error instanceof api.ApiError && error.field === 'replaces') this.diskConflict = !(await this.#isOfOtherFile());
      else if (error instanceof ConnectionError) this.notice = 'The text was not saved: the server does not respond. Save again after reconnection.';
      else this.failed(error);
    }
  }

  /** The text on disk and that of this page. */
  async compareWithDisk(): Promise<{ title: string; disk: string; here: string }[]> {
    const { name, text } = await api.mechanismFile();
    return [{ title: name, disk: text, here: this.work.text }];
  }

  /** Whether the server has another file than the shown one, which is then reported. */
  async #isOfOtherFile(): Promise<boolean> {
    const other = await otherFile(this.work.name, api.mechanismFile);
    if (other !== null) Object.assign(this, { diskConflict: false, notice: other });
    return other !== null;
  }

  /** Downloads the text as a file. */
  download(): void {
    const { name, text } = this.work;
    const link = document.createElement('a');
    link.href = URL.createObjectURL(new Blob([text], { type: 'application/toml' }));
    link.download = /\.toml$/.test(name) ? name : `${name || 'mechanism'}.toml`;
    link.click();
    URL.revokeObjectURL(link.href);
    this.work = { ...this.work, saved: text };
    this.#store();
  }

  // The configuration

  /** Drives a coordinate to a value: an expression in the units of the file. */
  drive(name: string, value: string): void {
    this.animated = null;
    this.#wanted = { ...this.#wanted, [name]: value };
    this.#start();
  }

  /** Whether a motion is wanted that was not sent yet. */
  get #isWanted(): boolean {
    return Object.keys(this.#wanted).length > 0 || this.#wantedPosition !== null;
  }

  /** Begins to move; a text that is being read may change the coordinates: the motion begins afterwards. */
  #start(): void {
    if (!this.moving && !this.reading && !this.#typing) void this.#move();
  }

  /** Takes a point of a link to be moved [m, in the frame of the link]. */
  takePoint(link: string, point_m: number[]): void {
    this.animated = null;
    this.point = { link, point_m, to_m: null, position_m: null, of: null, message: null };
    if (!this.moving) void this.#measurePoint();
  }

  /** Takes a point of the selected part, unless a point of its link was taken; without a selection, there is none. */
  takeSelected(): void {
    const { selected, document, point } = this;
    const found = document && selected && movingPoint(document, selected);
    if (!found) this.point = null;
    else if (point?.link !== found.link) this.takePoint(found.link, found.point_m);
  }

  /** Moves the point as near as possible to a position [m]; `as_drawn` is a position in the picture, with exaggerated play. */
  movePoint(to_m: number[], as_drawn: boolean): void {
    if (!this.point) return;
    this.animated = null;
    this.#wantedPosition = { to_m, as_drawn };
    if (!as_drawn) this.point = { ...this.point, to_m };
    this.#start();
  }

  /** Requests the position of the point in the shown configuration. */
  async #measurePoint(): Promise<void> {
    const { point, configuration, outdated } = this;
    if (!point || !configuration || outdated || point.of === configuration) return;
    try {
      const { position_m } = await api.reachMechanism(this.source, configuration.coordinates, point, null, 1);
      if (this.point === point && this.configuration === configuration) this.point = { ...point, position_m, of: configuration };
    } catch (error) {
      this.failed(error);
    }
  }

  /** Returns to the closed configuration near the guess of the file. */
  home(): void {
    void this.#read(null);
  }

  setPlayScale(scale: number): void {
    this.playScale = scale;
    if (!this.moving && !this.#scaling) void this.#scale();
  }

  /** Requests the poses at the last play scale; the configuration stays, and so do its analyses. */
  async #scale(): Promise<void> {
    this.#scaling = true;
    try {
      while (this.#posesScale !== this.playScale && this.configuration && !this.moving) {
        const { configuration, playScale } = this;
        const { poses } = await api.mechanismConfiguration(this.source, configuration.coordinates, playScale);
        if (this.configuration !== configuration) continue;
        this.poses = poses;
        this.#posesScale = playScale;
      }
    } catch (error) {
      this.failed(error);
    } finally {
      this.#scaling = false;
    }
  }

  #setConfiguration(configuration: ConfigurationDocument | null, scale: number): void {
    this.configuration = configuration;
    this.poses = configuration?.poses ?? null;
    this.#posesScale = scale;
    if (scale !== this.playScale && !this.#scaling) void this.#scale();
  }

  /** Shows another closed configuration. */
  show(configuration: ConfigurationDocument): void {
    this.animated = null;
    this.stopped = null;
    this.met = [];
    this.#setConfiguration(configuration, this.#modesScale);
    this.#settled();
  }

  async #move(): Promise<void> {
    this.moving = true;
    try {
      while (this.#isWanted && this.configuration && !this.reading && !this.#typing)
        if (this.#wantedPosition) await this.#reach(this.configuration);
        else await this.#drive(this.configuration);
    } finally {
      this.moving = false;
      this.setPlayScale(this.playScale);
      this.#settled();
    }
  }

  async #drive({ coordinates }: ConfigurationDocument): Promise<void> {
    const to = this.#wanted;
    this.#wanted = {};
    const { document, playScale } = this;
    try {
      const found = await api.driveMechanism(this.source, coordinates, to, playScale);
      if (document !== this.document) {
        // Another mechanism: its configuration is the start.
        this.#wanted = { ...to, ...this.#wanted };
        return;
      }
      this.#setConfiguration(found.configuration, playScale);
      if (this.point) this.point = { ...this.point, to_m: null, message: null };
      this.stopped = found.message ?? null;
      this.refused = {};
      this.#note(found);
    } catch (error) {
      const name = error instanceof api.ApiError && error.field?.startsWith('to.') ? error.field.slice(3) : null;
      if (name !== null && error instanceof Error) this.refused = { ...this.refused, [name]: error.message };
      else if (error instanceof api.ApiError) this.stopped = error.message;
      else this.failed(error);
    }
  }

  async #reach({ coordinates }: ConfigurationDocument): Promise<void> {
    const wanted = this.#wantedPosition;
    this.#wantedPosition = null;
    const { document, playScale, point } = this;
    if (!wanted || !point) return;
    try {
      const { configuration, position_m, message } = await api.reachMechanism(this.source, coordinates, point, wanted, playScale);
      if (document !== this.document) return;
      this.#setConfiguration(configuration, playScale);
      if (this.point?.link === point.link) this.point = { ...this.point, position_m, of: configuration, message: message ?? null };
      this.stopped = null;
      this.met = [];
    } catch (error) {
      if (error instanceof api.ApiError && this.point) this.point = { ...this.point, message: error.message };
      else this.failed(error);
    }
  }

  /** Notes what was met during a motion. */
  #note({ singular, first_beyond_limits, configuration }: api.DriveDocument): void {
    const met = singular.map(({ drives, branches }) => {
      const at = Object.entries(drives).map(([name, value]) => `${name} = ${this.format(name, value)}`).join(', ');
      const meet = branches === null || branches === undefined ? 'the number of branches is undecided' : branches === 1 ? 'no other branch crosses' : `${branches} branches meet`;
      return `Singular configuration at ${at}: ${meet}.`;
    });
    if (first_beyond_limits && configuration.limits_broken.length === 0) met.push(`Beyond limits during the motion, at ${first_beyond_limits.place}: ${first_beyond_limits.limits_broken.map(({ message }) => message).join('; ')}.`);
    this.met = met;
    const values = { ...this.singularValues };
    for (const { drives } of singular)
      for (const [name, value] of Object.entries(drives)) values[name] = [...new Set([...(values[name] ?? []), value])].slice(-8);
    this.singularValues = values;
  }

  /** A value of a coordinate with its unit. */
  format(name: string, value: number): string {
    const found = this.document?.coordinates.find((one) => one.name === name);
    return found ? withFileUnit(shownNumber(value, found.decimals), found.unit) : String(value);
  }

  // Analyses

  /** Computes the mobility after a pause. */
  #settled(): void {
    clearTimeout(this.#settle);
    this.#mobilityAbort?.abort();
    if (this.configuration)
      this.#settle = setTimeout(() => {
        void this.#computeMobility();
        void this.#measurePoint();
      }, SETTLED_MS);
  }

  async #computeMobility(): Promise<void> {
    const { configuration } = this;
    if (!configuration || this.moving) return;
    const abort = new AbortController();
    this.#mobilityAbort = abort;
    const done = (result: api.MobilityOfMechanism | null, problem: string | null) => {
      if (!abort.signal.aborted && this.configuration === configuration) this.mobility = { of: configuration, result, problem };
    };
    try {
      done(await api.mechanismMobility(this.source, configuration.coordinates, abort.signal), null);
    } catch (error) {
      if (error instanceof api.ApiError) done(null, error.message);
      else this.failed(error);
    }
  }

  async #analyse<T>(what: 'motions' | 'modes', ask: (configuration: ConfigurationDocument) => Promise<T>): Promise<Analysis<T> | null> {
    const { configuration } = this;
    if (!configuration) return null;
    this.computing = what;
    try {
      return { of: configuration, result: await ask(configuration), problem: null };
    } catch (error) {
      if (error instanceof api.ApiError) return { of: configuration, result: null, problem: error.message };
      this.failed(error);
      return null;
    } finally {
      this.computing = null;
    }
  }

  async computeMotions(): Promise<void> {
    this.motions = await this.#analyse('motions', ({ coordinates }) => api.mechanismMotions(this.source, coordinates));
    if (this.motions?.result?.motions.length) this.animated = 0;
  }

  async computeModes(): Promise<void> {
    this.#modesScale = this.playScale;
    this.modes = await this.#analyse('modes', ({ coordinates }) => api.mechanismBranches(this.source, coordinates, this.playScale));
  }

  async computeSuggestion(): Promise<void> {
    const of = this.sourceKey;
    this.computing = 'suggestion';
    try {
      this.suggestion = { of, result: await api.suggestVirtualJoints(this.source, new AbortController().signal), problem: null };
    } catch (error) {
      if (error instanceof api.ApiError) this.suggestion = { of, result: null, problem: error.message };
      else this.failed(error);
    } finally {
      this.computing = null;
    }
  }

  /** Identifies the text with its parameters. */
  get sourceKey(): string {
    return JSON.stringify([this.work.text, this.work.parameters]);
  }

  /** Replaces the virtual joints of the text by those of a suggested set. */
  async apply(set: number): Promise<void> {
    const text = this.suggestion?.result?.texts[set];
    if (text === undefined || this.suggestion?.of !== this.sourceKey) return;
    this.work = { ...this.work, text };
    await this.commit();
  }
}

export const mechanismSession = new MechanismSession();
