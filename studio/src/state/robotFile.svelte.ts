// The robot file under edit: its text, errors, and changes of its numbers.

import * as api from '../api/client';
import { ApiError, ConnectionError, type DimensionChange, type OpenedRobotDocument, type RobotDocument, type RobotSource } from '../api/client';
import { connection } from '../api/connection.svelte';

/** Pause in typing after which a text is read [ms]. */
const TYPING_PAUSE_MS = 350;

/** What the robot file does with the robot view. */
export interface RobotFileEvents {
  /** The text describes another robot than the one shown. */
  opened: (robot: RobotDocument) => void;
  /** A change of the text is complete: an undo step. */
  committed: () => void;
}

export class RobotFile {
  name = $state('');
  /** Whether it is a file of the server that can be saved. */
  writable = $state(false);
  /** The text; `null` until it is loaded. */
  text = $state.raw<string | null>(null);
  /** The text as last loaded or saved. */
  saved = $state.raw<string | null>(null);
  /** Values of parameters with which the server was started. */
  parameters = $state.raw<Record<string, number>>({});
  /** The answer to the last text that was read. */
  opened = $state.raw<OpenedRobotDocument | null>(null);
  /** The last text without errors, for requests; `null` for the robot of the server. */
  source = $state.raw<RobotSource | null>(null);
  notice = $state<string | null>(null);
  diskConflict = $state(false);
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
  /** Changes that are not sent yet, by number; only the newest value of each counts. */
  #changes = new Map<string, DimensionChange>();
  #readAgain = false;
  #work: Promise<void> | null = null;

  constructor(events: RobotFileEvents) {
    this.#events = events;
    connection.onReconnect(() => {
      if (this.text !== null) this.#read();
    });
    window.addEventListener('beforeunload', (event) => {
      if (this.changed) event.preventDefault();
    });
  }

  /** Loads the text, once. */
  start(): Promise<void> {
    this.#loading ??= this.reload().finally(() => {
      if (this.text === null) this.#loading = null;
    });
    return this.#loading;
  }

  /** Loads the text from the server again. */
  async reload(): Promise<void> {
    try {
      const { name, text, writable, version, parameters } = await api.robotFile();
      Object.assign(this, { name, writable, text, saved: text, parameters, diskConflict: false, notice: null });
      this.#version = version;
      this.#read();
      await this.settled();
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
    clearTimeout(this.#timer);
    this.#typing = false;
    Object.assign(this, { name, writable: false, text, saved: text, parameters: {}, diskConflict: false, notice: null });
    this.#read();
    this.#events.committed();
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
    this.#read();
    this.#events.committed();
  }

  /** Replaces the text, by undo. */
  restore(text: string): void {
    clearTimeout(this.#timer);
    this.#typing = false;
    if (text === this.text) return;
    this.text = text;
    this.#read();
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
        const changes = [...this.#changes.values()];
        this.#changes.clear();
        try {
          const opened = await api.openRobot({ text, parameters }, changes);
          // A text typed in the meantime is read next, without the changes of this one.
          if (this.text !== text) continue;
          this.text = opened.text;
          this.opened = opened;
          this.notice = null;
          if (!opened.robot) continue;
          this.source = { text: opened.text, parameters };
          this.#events.opened(opened.robot);
        } catch (error) {
          this.#failed(error);
          if (error instanceof ConnectionError) return;
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
    if (text === null) return;
    try {
      const { version } = await api.saveRobot(text, overwrite ? null : this.#version);
      this.#version = version;
      Object.assign(this, { saved: text, diskConflict: false, notice: null });
    } catch (error) {
      if (error instanceof ApiError && error.field === 'replaces') this.diskConflict = true;
      else if (error instanceof ConnectionError) this.notice = 'The robot was not saved: the server does not respond. Save again after reconnection.';
      else this.#failed(error);
    }
  }
}
