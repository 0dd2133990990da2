// State of the view of mechanisms: the text, its mechanism, the configuration, and the analyses of that configuration.

import * as api from '../api/client';
import { ConnectionError, type MechanismDocument, type MechanismSource, type OpenedDocument } from '../api/client';
import { connection } from '../api/connection.svelte';
import { otherFile } from '../api/otherFile';
import { History } from '../lib/history';
import type { CameraPose } from '../lib/hashParts';
import type { MechanismTab } from '../lib/mechanismLink';
import { kindOfFile } from '../lib/fileKind';
import { KINDS, rememberFile } from '../lib/recentFiles';
import { closesLoops } from '../lib/loopsFile';
import { fileSizeProblem, sizeProblem } from '../lib/requestSize';
import { textOf } from '../lib/textFile';
import { MechanismAnalyses, type Analysis } from './analyses.svelte';
import { ConfigurationController, type Selection } from './configurationController.svelte';
import type { PicturedView } from '../state/picture';
import type { RecordedView } from '../state/recorder.svelte';
import { TextDrafts } from '../state/textDrafts.svelte';

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

/** The 3D view, as far as other parts of the page use it. */
export interface MechanismSceneView extends PicturedView, RecordedView {
  cameraPose: CameraPose;
}

const EMPTY: Work = { name: '', text: '', parameters: {}, ofServer: false, saved: '' };

class MechanismSession {
  tab = $state<MechanismTab>('catalogue');
  work = $state.raw<Work>(EMPTY);
  /** The answer to the last text. */
  opened = $state.raw<OpenedDocument | null>(null);
  /** The last mechanism without errors. */
  document = $state.raw<MechanismDocument | null>(null);
  /** The 3D view, while there is one. */
  view: MechanismSceneView | null = null;
  /** A camera that the view is still to take over: that of a link, or of the view when it was last closed. */
  camera = $state.raw<CameraPose | null>(null);
  /** Whether catalogue and mechanism of the server are loaded. */
  started = $state(false);
  /** Number of texts shown; the camera is placed again for each. */
  shown = $state(0);
  entries = $state.raw<api.CatalogueEntry[]>([]);
  selected = $state.raw<Selection | null>(null);
  /** Index of the redundant constraint whose joints are highlighted. */
  redundant = $state<number | null>(null);
  notice = $state<string | null>(null);
  /** A file that another view shows, or of which this view shows a part. */
  otherView = $state.raw<{ kind: 'cell' | 'program' | 'three_rods'; name: string; text: string } | null>(null);
  diskConflict = $state(false);
  readonly drafts: TextDrafts = new TextDrafts('mechanism', () => this.work);
  reading = $state(false);
  canUndo = $state(false);
  canRedo = $state(false);
  /** Whether the text is being typed. */
  typing = $state(false);
  readonly controller: ConfigurationController = new ConfigurationController(this);
  readonly analyses: MechanismAnalyses = new MechanismAnalyses(this);
  changed = $derived(this.work.text !== this.work.saved || Object.keys(this.work.parameters).length > 0);
  diagnostics = $derived(this.opened?.diagnostics ?? []);
  /** Whether the text has errors: it is sent to be read only. */
  hasErrors = $derived(this.diagnostics.length > 0);
  /** Whether mechanism and configuration may differ from those of the text. */
  outdated = $derived(this.document !== null && (this.reading || this.typing || this.hasErrors || connection.state === 'disconnected'));
  /** Whether an analysis is that of the shown configuration. */
  current = (analysis: Analysis<unknown> | null): boolean => analysis !== null && analysis.of === this.controller.configuration && !this.outdated && !this.controller.moving;

  #model: Model | null = null;
  #version: string | null = null;
  #started = false;
  #history = new History<Work>(EMPTY);
  #timer: ReturnType<typeof setTimeout> | undefined;
  #settle: ReturnType<typeof setTimeout> | undefined;
  #abort: AbortController | null = null;

  constructor() {
    connection.onReconnect(() => {
      if (!this.#started) return;
      if (this.entries.length === 0) void this.#loadCatalogue();
      if (this.work.text !== '') void this.#read(this.#here);
    });
    window.addEventListener('beforeunload', (event) => {
      if (this.changed) event.preventDefault();
    });
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
    this.drafts.offer();
    this.started = true;
  }

  // Drafts

  /** Restores the offered text; undo returns to the previous one. */
  async restoreDraft(): Promise<void> {
    const draft = this.drafts.take();
    if (!draft) return;
    // Another file may have the same name: only changes of the very text of the server are saved into its file.
    const ofServer = draft.ofServer && this.work.ofServer && this.work.name === draft.name && this.work.saved === draft.saved;
    this.#model = null;
    this.work = { name: draft.name, text: draft.text, parameters: {}, ofServer, saved: ofServer ? this.work.saved : draft.saved };
    this.#commitWork();
    this.drafts.store();
    this.selected = null;
    this.controller.point = null;
    await this.#read(null);
    this.shown += 1;
    this.tab = this.diagnostics.length > 0 ? 'text' : 'tree';
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
    this.controller.playScale = 1;
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
      const { diagnostics, mechanism } = opened;
      const kind = kindOfFile(name, opened.kind);
      if (!mechanism && (diagnostics.length === 0 || kind === 'program')) {
        this.notice = `${name}: ${opened.note ?? 'a program is shown by the view of its work cell'}`;
        if (kind === 'cell' || kind === 'program') this.otherView = { kind, name, text };
        return false;
      }
      if (loops !== null && diagnostics.some(({ in_loops }) => in_loops)) {
        this.notice = `The file of loops has errors: ${diagnostics.map(({ line, message }) => `line ${line}: ${message}`).join('; ')}`;
        return false;
      }
      // That of the previous mechanism, if the view was closed in the meantime.
      this.camera = null;
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
    try {
      const texts = await Promise.all(files.map(async (file) => ({ name: file.name, text: await textOf(file) })));
      const loops = texts.find(closesLoops);
      const [other, more] = texts.filter((one) => one !== loops);
      if (more) {
        this.notice = 'Open one file, or a model with the file that closes its loops.';
        return;
      }
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
      this.controller.take(mechanism?.configuration ?? null, fresh, scale);
      this.redundant = null;
    }
    if (fresh) this.shown += 1;
    this.settled();
  }

  // The text

  edit(text: string): void {
    this.work = { ...this.work, text };
    this.typing = true;
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => void this.commit(), TYPING_PAUSE_MS);
  }

  /** Completes an edit: adds it to the undo history and reads the text. */
  async commit(): Promise<void> {
    clearTimeout(this.#timer);
    this.typing = false;
    if (this.#history.commit(this.work)) this.#updateHistory();
    this.drafts.store();
    await this.#read(this.#here);
  }

  /** Sets parameters and play scale, and closes the loops near given coordinates, or near the guess of the file. */
  async arrange(parameters: Record<string, number>, coordinates: number[] | null, playScale: number): Promise<void> {
    this.work = { ...this.work, parameters };
    this.controller.playScale = playScale;
    this.commitParameters();
    await this.#read(coordinates);
  }

  /** Coordinates of the shown configuration. */
  get #here(): number[] | null {
    return this.controller.configuration?.coordinates ?? null;
  }

  /** Reads the text again, near given coordinates or from its guess. */
  async #read(from: number[] | null): Promise<void> {
    this.#abort?.abort();
    const abort = new AbortController();
    this.#abort = abort;
    this.reading = true;
    try {
      const { playScale } = this.controller;
      const opened = await api.openMechanism(this.source, from, playScale, abort.signal);
      if (abort.signal.aborted) return;
      this.#take(opened, false, playScale);
      this.reading = false;
      this.controller.resume();
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
    if (this.typing) void this.commit();
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
      this.notice = null;
      if (this.work.ofServer) this.work = { ...this.work, saved: text };
      this.drafts.store();
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
    this.drafts.store();
  }

  /** Returns to the closed configuration near the guess of the file. */
  home(): void {
    void this.#read(null);
  }

  /** Computes what depends on the configuration, after a pause. */
  settled(): void {
    clearTimeout(this.#settle);
    this.analyses.cancelMobility();
    if (this.controller.configuration)
      this.#settle = setTimeout(() => {
        void this.analyses.computeMobility();
        void this.controller.measurePoint();
      }, SETTLED_MS);
  }

  /** Identifies the text with its parameters. */
  get sourceKey(): string {
    return JSON.stringify([this.work.text, this.work.parameters]);
  }

  /** Replaces the virtual joints of the text by those of a suggested set. */
  async apply(set: number): Promise<void> {
    const text = this.analyses.suggestedText(set);
    if (text === null) return;
    this.work = { ...this.work, text };
    await this.commit();
  }
}

export const mechanismSession = new MechanismSession();
