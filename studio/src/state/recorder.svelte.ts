// Records the 3D view as a video of 1920 × 1080 pixels with the encoder of the browser.

import type { Picture } from '../scene/picture';

/** A 3D view that can be recorded. */
export interface RecordedView {
  /** Called after each frame. */
  onFrame: (() => void) | null;
  /** Called before the view is removed. */
  onDispose: (() => void) | null;
  /** Requests a frame. */
  invalidate(): void;
  /** Renders the view to another canvas, without handles. */
  renderPicture(canvas: HTMLCanvasElement, picture: Picture, smooth?: boolean): boolean;
}

const KINDS = [
  ['video/mp4;codecs=avc1', 'mp4'],
  ['video/webm;codecs=vp9', 'webm'],
  ['video/webm;codecs=vp8', 'webm'],
  ['video/webm', 'webm'],
] as const;

/** Size of the video, with texts that are legible when it is reduced. */
const VIDEO = { width: 1920, height: 1080, scale: 1.5, transparent: false, labels: true } as const;

/** Number of frames of the first and of the last state: an encoder may start late, and a video ends at the start of its last frame. */
const HOLD_FRAMES = 4;
/** Minimum duration of these frames [ms]: three frames at 30 Hz. */
const HOLD_MS = 100;

export class VideoRecorder {
  running = $state(false);
  #end: (() => Promise<void>) | null = null;

  /** Starts recording; resolves after the first frames are encoded, to `false` if the recording was stopped before. */
  async start(renderer: RecordedView, note: () => string, done: (blob: Blob, extension: string) => void): Promise<boolean> {
    const kind = KINDS.find(([type]) => MediaRecorder.isTypeSupported(type));
    if (!kind) throw new Error('this browser does not support video encoding');
    const [type, extension] = kind;
    const canvas = document.createElement('canvas');
    renderer.renderPicture(canvas, { ...VIDEO, note: note() }, false);
    const recorder = new MediaRecorder(canvas.captureStream(30), { mimeType: type, videoBitsPerSecond: 12e6 });
    const parts: Blob[] = [];
    recorder.addEventListener('dataavailable', ({ data }) => data.size > 0 && parts.push(data));
    recorder.addEventListener('stop', () => done(new Blob(parts, { type }), extension));
    const waiting: (() => void)[] = [];
    renderer.onFrame = () => {
      renderer.renderPicture(canvas, { ...VIDEO, note: note() }, false);
      for (const next of waiting.splice(0)) next();
    };
    let ended = false;
    const finish = () => {
      if (ended) return;
      ended = true;
      this.#end = null;
      renderer.onFrame = renderer.onDispose = null;
      for (const next of waiting.splice(0)) next();
      recorder.stop();
      this.running = false;
    };
    // A view that is removed renders no more frames: the film ends with the last one.
    renderer.onDispose = finish;
    const hold = async () => {
      const until = performance.now() + HOLD_MS;
      for (let frame = 0; !ended && (frame < HOLD_FRAMES || performance.now() < until); frame++)
        await new Promise<void>((next) => {
          waiting.push(next);
          renderer.invalidate();
        });
    };
    this.#end = async () => {
      await hold();
      finish();
    };
    this.running = true;
    recorder.start(500);
    await hold();
    return this.#end !== null;
  }

  /** Records the last state for some frames, and ends the video. */
  async stop(): Promise<void> {
    const end = this.#end;
    this.#end = null;
    await end?.();
  }
}
