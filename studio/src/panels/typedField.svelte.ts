// The text of a number field: its evaluation, and the message about it.

import { sentence } from '../lib/text';
import { typedQuantity, type FieldUnit } from './typedQuantity';

/** What a field does with its text. */
export interface TypedFieldEvents {
  /** Takes a value; an error that it throws refuses the value. */
  accept: (value: number) => void;
  /** Shows the value of the field again in place of a refused text. */
  restore: () => void;
}

export class TypedField {
  /** Field with the last change: a message is about that one only. */
  static #last: TypedField | null = null;

  message = $state('');
  #isRefusal = false;
  /** Number of the last text: an earlier one may be evaluated later. */
  #latest = 0;

  /** Begins a change of the field: messages about former changes end. */
  begin(): void {
    if (TypedField.#last && TypedField.#last !== this) TypedField.#last.message = '';
    TypedField.#last = this;
    this.message = '';
  }

  /** The value of the field has changed: a refused text is not that of the field any more. */
  valueChanged(): void {
    if (this.#isRefusal) this.message = '';
  }

  /** Reports about a value that was accepted in part. */
  note(message: string): void {
    this.message = message;
    this.#isRefusal = false;
  }

  /** Evaluates a text; `missing` is the message about an empty one. */
  change(text: string, unit: FieldUnit, missing: string, { accept, restore }: TypedFieldEvents): void {
    this.begin();
    const number = ++this.#latest;
    const refuse = (why: unknown) => {
      if (number !== this.#latest) return;
      this.message = sentence(why);
      this.#isRefusal = true;
      restore();
    };
    const take = (value: number) => {
      if (number !== this.#latest) return;
      try {
        accept(value);
      } catch (error) {
        refuse(error);
      }
    };
    if (text.trim() === '') return refuse(missing);
    const value = typedQuantity(text, unit);
    if (typeof value === 'number') take(value);
    else void value.then(take, refuse);
  }
}
