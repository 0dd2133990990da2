/** Undo history of immutable values. */
export class History<T> {
  #past: T[] = [];
  #future: T[] = [];
  #present: T;
  readonly #limit: number;

  constructor(present: T, limit = 500) {
    this.#present = present;
    this.#limit = limit;
  }

  get present(): T {
    return this.#present;
  }

  get canUndo(): boolean {
    return this.#past.length > 0;
  }

  get canRedo(): boolean {
    return this.#future.length > 0;
  }

  /** Adds a step with all changes since the last one; returns whether there were any. */
  commit(value: T): boolean {
    if (same(value, this.#present)) return false;
    this.#past.push(this.#present);
    if (this.#past.length > this.#limit) this.#past.shift();
    this.#present = value;
    this.#future = [];
    return true;
  }

  /** Replaces the present value without a step. */
  replace(value: T): void {
    this.#present = value;
  }

  undo(): T | undefined {
    const before = this.#past.pop();
    if (before === undefined) return undefined;
    this.#future.push(this.#present);
    this.#present = before;
    return before;
  }

  redo(): T | undefined {
    const after = this.#future.pop();
    if (after === undefined) return undefined;
    this.#past.push(this.#present);
    this.#present = after;
    return after;
  }
}

function same(a: unknown, b: unknown): boolean {
  return JSON.stringify(a) === JSON.stringify(b);
}
