// The robot file under edit: its text, errors, and changes of its numbers.

import * as api from '../api/client';
import { ApiError, ConnectionError, type DimensionChange, type OpenedRobotDocument, type RobotDocument, type RobotSource } from '../api/client';
import { connection } from '../api/connection.svelte';
import { otherFile } from '../api/otherFile';
import type { RobotWork } from '../lib/document';
import { TextDrafts } from './textDrafts.svelte';

/** Pause in typing after which a text is read [ms]. */
const TYPING_PAUSE_MS = 350;

/** What the robot file does with the robot view. */
export interface RobotFileEvents {
  /** The text describes another robot than the one shown. */
  opened: (robot: RobotDocument) => void;
  /** A change of the text is complete: an undo step, once all requests have been answered. */
  committed: () => Promise<void>;
}

export class RobotFile {
  name = $state('');
  /** The text; `null` until it is loaded. */
  text = $state.raw<string | null>(null);
  /** Values of parameters in place of those of the text: those with which the server was started. */
  parameters = $state.raw<Record<string, number>>({});
  /** The text as it was opened in this browser; `null` for the file of the server. */
  openedText = $state.raw<string | null>(null);
  /** The file of the server: whether it can be saved, and its text as last loaded or saved. */
  #server = $state.raw<{ writable: boolean; saved: string | null }>({ writable: false, saved: null });
  /** Whether it is a file of the server that can be saved. */
  writable = $derived(this.openedText === null && this.#server.writable);
  /** The text as last loaded, opened or saved. */
  saved = $derived(this.openedText ?? this.#server.saved);
  /** The answer to the last text that was read. */
  opened = $state.raw<OpenedRobotDocument | null>(null);
  /** The last text without errors, for requests; `null` for the robot of the server. */
  source = $state.raw<RobotSource | null>(null);
  notice = $state<string | null>(null);
  diskConflict = $state(false);
  readonly drafts: TextDrafts = new TextDrafts('robot', () => (this.text === null || this.saved === null ? null : { name: this.name, text: this.text, saved: this.saved, ofServer: this.openedText === null }));
  #typing = $state(false);
  #reading = $state(false);
  changed = $derived(this.text !== this.saved);
  diagnostics = $derived(this.opened?.diagnostics ?? []);
  /** Whether the robot may differ from that of the text. */
  outdated = $derived(this.text !== null && (this.#typing || this.#reading || this.diagnostics.length > 0 || connection.state === 'disconnected'));

  readonly #events: RobotFileEvents;
  #version: string | null = null;
  #loading: Promise<void> | null = null;
  #timer: ReturnType<typeof setTimeout> | undefined;
  /** Changes that the server has not made yet, by number; only the newest value of each counts. */
  #changes = new Map<string, DimensionChange>();
  /** Whether changes wait for the reconnection: they are then an undo step. */
  #waiting = false;
  #readAgain = false;
  #work: Promise<void> | null = null;

  constructor(events: RobotFileEvents) {
    this.#events = events;
    connection.onReconnect(() => {
      if (this.text !== null) this.#read();
    });
    window.addEventListener('beforeunload', (event) => {
      if (this.changed || this.#changes.size > 0) event.preventDefault();
    });
  }

  /** Loads the text, once. */
  start(): Promise<void> {
    this.#loading ??= this.reload().finally(() => {
      if (this.text === null) this.#loading = null;
    });
    return this.#loading;
  }

  /** The text with what belongs to it, for undo; `null` until it is loaded. */
  get work(): RobotWork | null {
    const { name, text, parameters, openedText } = this;
    return text === null ? null : { name, text, parameters, opened: openedText };
  }

  /** Shows another text; changes of the previous one are dropped. */
  #show({ name, text, parameters, opened }: RobotWork): void {
    clearTimeout(this.#timer);
    this.#typing = false;
    this.cancelChanges();
    Object.assign(this, { name, text, parameters, openedText: opened, diskConflict: false, notice: null });
    this.#read();
  }

  /** Loads the text from the server again, unless this is aborted before; undo returns to the previous one. */
  async reload(signal?: AbortSignal): Promise<void> {
    try {
      const { name, text, writable, version, parameters } = await api.robotFile();
      const isFirst = this.text === null;
      if (!isFirst) await this.#completeEdits();
      if (signal?.aborted) return;
      this.#version = version;
      this.#server = { writable, saved: text };
      this.#show({ name, text, parameters, opened: null });
      await this.settled();
      if (!isFirst) void this.#events.committed();
    } catch (error) {
      this.#failed(error);
    }
  }

  #failed(error: unknown): void {
    // Disconnection is shown in the header, and the text is read again.
    if (error instanceof ConnectionError) return;
    this.notice = error instanceof Error ? error.message : String(error);
  }

  /** Resolves when the robot is that of the text. */
  async settled(): Promise<void> {
    while (this.#work) await this.#work;
  }

  /** Opens another robot: its text is not that of the file of the server, and is downloaded instead of saved. */
  async open(name: string, text: string): Promise<void> {
    // So that undo restores the robot of the server.
    await this.start();
    await this.#completeEdits();
    this.#show({ name, text, parameters: {}, opened: text });
    void this.#events.committed();
  }

  /** Restores the text of an earlier visit; undo returns to the previous one. */
  async restoreDraft(): Promise<void> {
    await this.start();
    // Without a connection, the text remains offered.
    if (this.text === null) return;
    const draft = this.drafts.take();
    if (!draft) return;
    await this.#completeEdits();
    // Another file may have the same name: only changes of the very text of the server are saved into its file.
    const ofServer = draft.ofServer && this.openedText === null && this.name === draft.name && this.#server.saved === draft.saved;
    this.#show({ name: draft.name, text: draft.text, parameters: ofServer ? this.parameters : {}, opened: ofServer ? null : draft.saved });
    this.drafts.store();
    void this.#events.committed();
  }

  /** Adds edits in progress to the undo history. */
  async #completeEdits(): Promise<void> {
    if (this.#typing) this.#typed();
    await this.#events.committed();
  }

  /** Changes the text while the user types. */
  edit(text: string): void {
    this.text = text;
    this.#typing = true;
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.#typed(), TYPING_PAUSE_MS);
  }

  #typed(): void {
    clearTimeout(this.#timer);
    this.#typing = false;
    this.drafts.store();
    this.#read();
    void this.#events.committed();
  }

  /** Returns to a text with what belongs to it, by undo. */
  restore(work: RobotWork): void {
    if (JSON.stringify(work) !== JSON.stringify(this.work)) this.#show(work);
  }

  /** Drops the changes that the server has not made yet; returns whether there were any. */
  cancelChanges(): boolean {
    const pending = this.#changes.size > 0;
    this.#changes.clear();
    this.#waiting = false;
    return pending;
  }

  /** Replaces numbers in the text; comments remain. */
  change(changes: DimensionChange[]): void {
    if (this.#typing) this.#typed();
    for (const change of changes) {
      this.#changes.set(JSON.stringify([change.dimension, change.limb, change.name]), change);
      if (change.name && change.name in this.parameters) {
        const { [change.name]: _, ...others } = this.parameters;
        this.parameters = others;
      }
    }
    this.#read();
  }

  #read(): void {
    this.#readAgain = true;
    this.#work ??= this.#process();
  }

  /** Reads the text with the pending changes, one request at a time. */
  async #process(): Promise<void> {
    this.#reading = true;
    try {
      while (this.#readAgain && this.text !== null) {
        this.#readAgain = false;
        const { text, parameters } = this;
        const changes = [...this.#changes];
        const taken = () => changes.forEach(([key, change]) => this.#changes.get(key) === change && this.#changes.delete(key));
        try {
          const opened = await api.openRobot({ text, parameters }, changes.map(([, change]) => change));
          // A text typed in the meantime is read next, with the same changes.
          if (this.text !== text) continue;
          taken();
          if (this.#waiting && this.#changes.size === 0) {
            this.#waiting = false;
            void this.#events.committed();
          }
          this.text = opened.text;
          this.drafts.store();
          this.opened = opened;
          this.notice = null;
          if (!opened.robot) continue;
          this.source = { text: opened.text, parameters };
          this.#events.opened(opened.robot);
        } catch (error) {
          if (error instanceof ConnectionError) {
            // The changes remain until the server responds again.
            this.#waiting = this.#changes.size > 0;
            return;
          }
          taken();
          this.#failed(error);
        }
      }
    } finally {
      this.#reading = false;
      this.#work = null;
    }
  }

  /** Saves the text to the file of the server. */
  async save(overwrite = false): Promise<void> {
    if (this.#typing) this.#typed();
    await this.settled();
    const { text } = this;
    if (text === null || this.openedText !== null) return;
    try {
      if (overwrite && (await this.#isOfOtherFile())) return;
      const { version } = await api.saveRobot(text, overwrite ? null : this.#version);
      this.#version = version;
      this.#server = { ...this.#server, saved: text };
      Object.assign(this, { diskConflict: false, notice: null });
      this.drafts.store();
    } catch (error) {
      if (error instanceof ApiError && error.field === 'replaces') this.diskConflict = !(await this.#isOfOtherFile());
      else if (error instanceof ConnectionError) this.notice = 'The robot was not saved: the server does not respond. Save again after reconnection.';
      else this.#failed(error);
    }
  }

  /** The text on disk and that of this page. */
  async compareWithDisk(): Promise<{ title: string; disk: string; here: string }[]> {
    const { name, text } = await api.robotFile();
    return [{ title: name, disk: text, here: this.text ?? '' }];
  }

  /** Whether the server has another file than the shown one, which is then reported. */
  async #isOfOtherFile(): Promise<boolean> {
    const other = await otherFile(this.name, api.robotFile);
    if (other !== null) Object.assign(this, { diskConflict: false, notice: other });
    return other !== null;
  }
}
