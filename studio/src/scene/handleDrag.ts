// The drag handles of a view, and their drags by the pointer.

import { Vector2, type Raycaster, type Scene } from 'three';
import { DESCRIPTIONS, type Freedom, type Handles } from './handles';

export interface DragEvents {
  /** A drag of a handle has begun. */
  dragStart: (freedom: Freedom) => void;
  /** The displacement since the start of the drag has changed [mm or degrees]. */
  drag: (freedom: Freedom, displacement: number) => void;
  /** The drag has ended, and is accepted or cancelled. */
  dragEnd: (accepted: boolean) => void;
}

/** The view that has the handles. */
export interface HandleView {
  canvas: HTMLCanvasElement;
  scene: Scene;
  ray: (event: PointerEvent) => Raycaster;
  /** Displacement of a handle for a pointer movement [px]: in mm or degrees. */
  displacement: (handles: Handles, freedom: Freedom, moved: Vector2) => number;
  invalidate: () => void;
}

export class HandleDrag {
  readonly #view: HandleView;
  readonly #events: DragEvents;
  #handles: Handles | null = null;
  #drag: { freedom: Freedom; start: Vector2 } | null = null;

  constructor(view: HandleView, events: DragEvents) {
    this.#view = view;
    this.#events = events;
    // Registered for the capture phase: a drag of a handle must not reach the camera controls.
    view.canvas.addEventListener('pointerdown', (event) => this.#grab(event), { capture: true });
    view.canvas.addEventListener('pointermove', (event) => this.#move(event));
  }

  get handles(): Handles | null {
    return this.#handles;
  }

  /** Whether a handle is being dragged. */
  get isActive(): boolean {
    return this.#drag !== null;
  }

  /** Replaces the handles. */
  replace(handles: Handles | null): void {
    if (this.#handles) {
      this.#view.scene.remove(this.#handles.group);
      this.#handles.dispose();
    }
    this.#handles = handles;
    if (handles) this.#view.scene.add(handles.group);
  }

  #grab(event: PointerEvent): void {
    const freedom = event.button === 0 ? this.#handles?.pick(this.#view.ray(event)) : null;
    if (!freedom) return;
    const { canvas } = this.#view;
    event.stopImmediatePropagation();
    this.#drag = { freedom, start: new Vector2(event.clientX, event.clientY) };
    canvas.setPointerCapture(event.pointerId);
    this.#events.dragStart(freedom);
    const end = (ended: Event) => {
      this.#drag = null;
      canvas.removeEventListener('pointerup', end);
      canvas.removeEventListener('pointercancel', end);
      this.#events.dragEnd(ended.type === 'pointerup');
    };
    canvas.addEventListener('pointerup', end);
    canvas.addEventListener('pointercancel', end);
  }

  #move(event: PointerEvent): void {
    if (!this.#handles) return;
    if (this.#drag) {
      const { freedom, start } = this.#drag;
      const moved = new Vector2(event.clientX, event.clientY).sub(start);
      this.#events.drag(freedom, this.#view.displacement(this.#handles, freedom, moved));
      return;
    }
    if (event.buttons !== 0) return;
    const hovered = this.#handles.pick(this.#view.ray(event));
    const { canvas } = this.#view;
    canvas.style.cursor = hovered ? 'grab' : '';
    canvas.title = hovered ? `Drag: ${DESCRIPTIONS[hovered]}` : '';
    if (this.#handles.highlight(hovered)) this.#view.invalidate();
  }
}
