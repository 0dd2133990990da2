// The text of a number field: while it is edited, its evaluation, and the message about it.

import { sentence } from '../lib/text';
import { typedQuantity, type FieldUnit } from './typedQuantity';

export class TypedField {
  /** Field with the last change: a message is about that one only. */
  static #last: TypedField | null = null;

  message = $state('');
  #isRefusal = false;
  /** The text where it is not that of the value: as typed so far, under evaluation, or accepted and not yet the value. */
  text = $state<string | null>(null);
  /** Whether the text is being typed: values that arrive in the meantime do not replace it. */
  #isTyped = false;
  /** Number of the last text: an earlier one may be evaluated later. */
  #latest = 0;

  /** Begins a change of the field: texts that are being typed, and messages about former changes, end. */
  begin(): void {
    if (TypedField.#last && TypedField.#last !== this) TypedField.#last.message = '';
    TypedField.#last = this;
    this.message = '';
    this.cancel();
  }

  /** A text has been typed, and not entered; `shown` is that of the value. */
  type(text: string, shown: string): void {
    this.message = '';
    this.#isTyped = text !== shown;
    this.text = this.#isTyped ? text : null;
  }

  /** Shows the value of the field in place of a text that was typed, and not entered. */
  cancel(): void {
    if (this.#isTyped) this.text = null;
    this.#isTyped = false;
  }

  /** The value of the field has changed: a refused text is not that of the field any more. */
  valueChanged(): void {
    if (this.#isRefusal) this.message = '';
    if (!this.#isTyped) this.text = null;
  }

  /** Reports about a value that was accepted in part. */
  note(message: string): void {
    this.message = message;
    this.#isRefusal = false;
  }

  /**
   * Evaluates a text that has been entered; `missing` is the message about an empty one.
   *
   * `accept` takes the value, and returns the text to show until it is that of the field, if any; an error that it throws refuses the value.
   */
  enter(text: string, unit: FieldUnit, missing: string, accept: (value: number) => string | null): void {
    this.begin();
    this.text = text;
    const number = ++this.#latest;
    /** Another text may be typed already. */
    const show = (text: string | null) => {
      if (!this.#isTyped) this.text = text;
    };
    const refuse = (why: unknown) => {
      if (number !== this.#latest) return;
      this.message = sentence(why);
      this.#isRefusal = true;
      show(null);
    };
    const take = (value: number) => {
      if (number !== this.#latest) return;
      try {
        show(accept(value));
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
