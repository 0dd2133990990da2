// Moves the mechanism: one request at a time, and only the last pending one of each coordinate is sent.

import * as api from '../api/client';
import type { ConfigurationDocument, MechanismDocument, MechanismSource } from '../api/client';
import type { MechanismLink } from '../lib/mechanismLink';
import { shownNumber } from '../lib/shownNumber';
import { withFileUnit } from '../lib/units';

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

/** A selected part of a mechanism. */
export type Selection = NonNullable<MechanismLink['selected']>;

/** The part of the session that the motion depends on. */
export interface ConfigurationContext {
  /** The mechanism of requests. */
  readonly source: MechanismSource;
  readonly document: MechanismDocument | null;
  readonly selected: Selection | null;
  /** Whether the text is being read: it may change the coordinates. */
  readonly reading: boolean;
  /** Whether the text is being typed. */
  readonly typing: boolean;
  /** Whether the text has errors: it describes no mechanism to be moved. */
  readonly hasErrors: boolean;
  /** Whether mechanism and configuration may differ from those of the text. */
  readonly outdated: boolean;
  /** Called in each configuration in which the mechanism rests. */
  settled(): void;
  failed(error: unknown): void;
}

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

export class ConfigurationController {
  configuration = $state.raw<ConfigurationDocument | null>(null);
  /** Poses of the links at the play scale, once they differ from those of the configuration. */
  poses = $state.raw<ConfigurationDocument['poses'] | null>(null);
  playScale = $state(1);
  point = $state.raw<MovedPoint | null>(null);
  /** Why the last motion stopped, or what it met. */
  stopped = $state<string | null>(null);
  met = $state.raw<string[]>([]);
  /** Values of driven coordinates at singular configurations that were met, by name. */
  singularValues = $state.raw<Record<string, number[]>>({});
  /** Errors by coordinate: values that cannot be commanded. */
  refused = $state.raw<Record<string, string>>({});
  moving = $state(false);
  /** The animated instantaneous motion. */
  animated = $state<number | null>(null);

  readonly #context: ConfigurationContext;
  /** Wanted values of driven coordinates that were not sent yet. */
  #wanted: Record<string, string> = {};
  /** Wanted position of the point that was not sent yet. */
  #wantedPosition: { to_m: number[]; as_drawn: boolean } | null = null;
  #scaling = false;
  /** Play scale of the poses. */
  #posesScale = 1;

  constructor(context: ConfigurationContext) {
    this.#context = context;
  }

  /** Takes over the configuration of a text that was read; `isOther`: the text of another mechanism. */
  take(configuration: ConfigurationDocument | null, isOther: boolean, scale: number): void {
    this.#setConfiguration(configuration, scale);
    this.stopped = null;
    this.met = [];
    this.refused = {};
    this.singularValues = {};
    this.animated = null;
    if (!isOther) return;
    this.#wanted = {};
    this.point = null;
  }

  /** Continues a motion that waited for a text to be read. */
  resume(): void {
    if (this.#isWanted && !this.moving && this.#isReadable) void this.#move();
  }

  /** Drives a coordinate to a value: an expression in the units of the file. */
  drive(name: string, value: string): void {
    if (this.#context.hasErrors) return;
    this.animated = null;
    this.#wanted = { ...this.#wanted, [name]: value };
    this.#start();
  }

  /** Whether a motion is wanted that was not sent yet. */
  get #isWanted(): boolean {
    return Object.keys(this.#wanted).length > 0 || this.#wantedPosition !== null;
  }

  /** Whether the text describes the mechanism: a text that is being read may change the coordinates, and one with errors has none. */
  get #isReadable(): boolean {
    return !this.#context.reading && !this.#context.typing && !this.#context.hasErrors;
  }

  /** Begins to move, or waits until the text is read without errors. */
  #start(): void {
    if (!this.moving && this.#isReadable) void this.#move();
  }

  /** Takes a point of a link to be moved [m, in the frame of the link]. */
  takePoint(link: string, point_m: number[]): void {
    this.animated = null;
    this.point = { link, point_m, to_m: null, position_m: null, of: null, message: null };
    if (!this.moving) void this.measurePoint();
  }

  /** Takes a point of the selected part, unless a point of its link was taken; without a selection, there is none. */
  takeSelected(): void {
    const { selected, document } = this.#context;
    const { point } = this;
    const found = document && selected && movingPoint(document, selected);
    if (!found) this.point = null;
    else if (point?.link !== found.link) this.takePoint(found.link, found.point_m);
  }

  /** Moves the point as near as possible to a position [m]; `as_drawn` is a position in the picture, with exaggerated play. */
  movePoint(to_m: number[], as_drawn: boolean): void {
    if (!this.point || this.#context.hasErrors) return;
    this.animated = null;
    this.#wantedPosition = { to_m, as_drawn };
    if (!as_drawn) this.point = { ...this.point, to_m };
    this.#start();
  }

  /** Requests the position of the point in the shown configuration. */
  async measurePoint(): Promise<void> {
    const { point, configuration } = this;
    if (!point || !configuration || this.#context.outdated || point.of === configuration) return;
    try {
      const { position_m } = await api.reachMechanism(this.#context.source, configuration.coordinates, point, null, 1);
      if (this.point === point && this.configuration === configuration) this.point = { ...point, position_m, of: configuration };
    } catch (error) {
      this.#context.failed(error);
    }
  }

  setPlayScale(scale: number): void {
    this.playScale = scale;
    if (!this.moving && !this.#scaling) void this.#scale();
  }

  /** Requests the poses at the last play scale; the configuration stays, and so do its analyses. */
  async #scale(): Promise<void> {
    this.#scaling = true;
    try {
      while (this.#posesScale !== this.playScale && this.configuration && !this.moving && !this.#context.hasErrors) {
        const { configuration, playScale } = this;
        const { poses } = await api.mechanismConfiguration(this.#context.source, configuration.coordinates, playScale);
        if (this.configuration !== configuration) continue;
        this.poses = poses;
        this.#posesScale = playScale;
      }
    } catch (error) {
      this.#context.failed(error);
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

  /** Shows another closed configuration, with its poses at a play scale. */
  show(configuration: ConfigurationDocument, scale: number): void {
    this.animated = null;
    this.stopped = null;
    this.met = [];
    this.#setConfiguration(configuration, scale);
    this.#context.settled();
  }

  async #move(): Promise<void> {
    this.moving = true;
    try {
      while (this.#isWanted && this.configuration && this.#isReadable)
        if (this.#wantedPosition) await this.#reach(this.configuration);
        else await this.#drive(this.configuration);
    } finally {
      this.moving = false;
      this.setPlayScale(this.playScale);
      this.#context.settled();
    }
  }

  async #drive({ coordinates }: ConfigurationDocument): Promise<void> {
    const to = this.#wanted;
    this.#wanted = {};
    const { playScale } = this;
    const { document } = this.#context;
    try {
      const found = await api.driveMechanism(this.#context.source, coordinates, to, playScale);
      if (document !== this.#context.document) {
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
      else this.#context.failed(error);
    }
  }

  async #reach({ coordinates }: ConfigurationDocument): Promise<void> {
    const wanted = this.#wantedPosition;
    this.#wantedPosition = null;
    const { playScale, point } = this;
    const { document } = this.#context;
    if (!wanted || !point) return;
    try {
      const { configuration, position_m, message } = await api.reachMechanism(this.#context.source, coordinates, point, wanted, playScale);
      if (document !== this.#context.document) return;
      this.#setConfiguration(configuration, playScale);
      if (this.point?.link === point.link) this.point = { ...this.point, position_m, of: configuration, message: message ?? null };
      this.stopped = null;
      this.met = [];
    } catch (error) {
      if (error instanceof api.ApiError && this.point) this.point = { ...this.point, message: error.message };
      else this.#context.failed(error);
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
    const found = this.#context.document?.coordinates.find((one) => one.name === name);
    return found ? withFileUnit(shownNumber(value, found.decimals), found.unit) : String(value);
  }
}
