// The view as a video, by the browser's own encoder.

import type { RobotRenderer } from '../scene/robotRenderer';

const KINDS = [
  ['video/mp4;codecs=avc1', 'mp4'],
  ['video/webm;codecs=vp9', 'webm'],
  ['video/webm;codecs=vp8', 'webm'],
  ['video/webm', 'webm'],
] as const;

/** Pictures of the first and of the last moment: an encoder may begin late, and a film ends where its last picture begins. */
const HELD = 4;
/** How long these moments are held at least: at 30 pictures a second, three of them [ms]. */
const HOLD = 100;

export class VideoRecorder {
  running = $state(false);
  #end: (() => Promise<void>) | null = null;

  /** Resolves once the first moment is in the film and what moves may move; to false if it was stopped meanwhile. */
  async start(viewer: RobotRenderer, note: () => string, done: (blob: Blob, ending: string) => void): Promise<boolean> {
    const kind = KINDS.find(([type]) => MediaRecorder.isTypeSupported(type));
    if (!kind) throw new Error('this browser does not support video encoding');
    const [type, ending] = kind;
    const canvas = document.createElement('canvas');
    viewer.copyTo(canvas, note());
    const recorder = new MediaRecorder(canvas.captureStream(30), { mimeType: type, videoBitsPerSecond: 12e6 });
    const parts: Blob[] = [];
    recorder.addEventListener('dataavailable', ({ data }) => data.size > 0 && parts.push(data));
    recorder.addEventListener('stop', () => done(new Blob(parts, { type }), ending));
    const waiting: (() => void)[] = [];
    viewer.film = () => {
      viewer.copyTo(canvas, note());
      for (const next of waiting.splice(0)) next();
    };
    const hold = async () => {
      const until = performance.now() + HOLD;
      for (let picture = 0; picture < HELD || performance.now() < until; picture++)
        await new Promise<void>((next) => {
          waiting.push(next);
          viewer.invalidate();
        });
    };
    this.#end = async () => {
      await hold();
      viewer.film = null;
      recorder.stop();
      this.running = false;
    };
    this.running = true;
    recorder.start(500);
    await hold();
    return this.#end !== null;
  }

  /** Holds the last moment, and hands the film over. */
  async stop(): Promise<void> {
    const end = this.#end;
    this.#end = null;
    await end?.();
  }
}
