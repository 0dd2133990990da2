// The view as a video, by the browser's own encoder.

import type { Viewer } from '../scene/viewer';

const KINDS = [
  ['video/mp4;codecs=avc1', 'mp4'],
  ['video/webm;codecs=vp9', 'webm'],
  ['video/webm;codecs=vp8', 'webm'],
  ['video/webm', 'webm'],
] as const;

export class Film {
  running = $state(false);
  #recorder: MediaRecorder | null = null;
  #viewer: Viewer | null = null;

  start(viewer: Viewer, note: () => string, done: (blob: Blob, ending: string) => void): void {
    const kind = KINDS.find(([type]) => MediaRecorder.isTypeSupported(type));
    if (!kind) throw new Error('this browser encodes no video');
    const [type, ending] = kind;
    const canvas = document.createElement('canvas');
    viewer.copyTo(canvas, note());
    const recorder = new MediaRecorder(canvas.captureStream(30), { mimeType: type, videoBitsPerSecond: 12e6 });
    const parts: Blob[] = [];
    recorder.addEventListener('dataavailable', ({ data }) => data.size > 0 && parts.push(data));
    recorder.addEventListener('stop', () => done(new Blob(parts, { type }), ending));
    recorder.start(500);
    viewer.film = () => viewer.copyTo(canvas, note());
    viewer.invalidate();
    this.#recorder = recorder;
    this.#viewer = viewer;
    this.running = true;
  }

  stop(): void {
    this.#recorder?.stop();
    if (this.#viewer) this.#viewer.film = null;
    this.#recorder = null;
    this.#viewer = null;
    this.running = false;
  }
}
