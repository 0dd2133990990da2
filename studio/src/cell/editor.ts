// Text editor with inline diagnostics and a marker of the executed line.

import { defaultKeymap, history, historyKeymap, indentWithTab, redo, undo } from '@codemirror/commands';
import { HighlightStyle, StreamLanguage, syntaxHighlighting } from '@codemirror/language';
import { lintGutter, setDiagnostics, type Diagnostic } from '@codemirror/lint';
import { EditorState, StateEffect, StateField, Transaction, type Extension } from '@codemirror/state';
import { Decoration, drawSelection, EditorView, highlightActiveLineGutter, keymap, lineNumbers, type DecorationSet } from '@codemirror/view';
import { tags } from '@lezer/highlight';
import { withLineEnds, withoutReturns } from '../lib/lineEnds';

export interface EditorDiagnostic {
  line: number;
  column: number;
  width: number;
  message: string;
  severity: 'error' | 'warning';
}

/** Highlighting of programs with the given reserved words. */
const programLanguage = (keywords: readonly string[]) => {
  const keyword = new RegExp(`^(${keywords.join('|')})\\b`, 'i');
  return StreamLanguage.define({
    token(stream) {
      if (stream.eatSpace()) return null;
      if (stream.match(/^#.*/)) return 'comment';
      if (stream.match(/^"(?:[^"]|"")*"/)) return 'string';
      if (stream.match(/^-?\d+(\.\d+)?/)) return 'number';
      if (stream.match(keyword)) return 'keyword';
      if (stream.match(/^[A-Za-z_][\w-]*/)) return 'variableName';
      stream.next();
      return null;
    },
  });
};

const toml = StreamLanguage.define({
  token(stream) {
    if (stream.eatSpace()) return null;
    if (stream.match(/^#.*/)) return 'comment';
    if (stream.sol() && stream.match(/^\[+[^\]]*\]+/)) return 'keyword';
    if (stream.match(/^"(?:[^"\\]|\\.)*"/)) return 'string';
    if (stream.match(/^[+-]?\d[\d_.eE+-]*/)) return 'number';
    if (stream.match(/^(true|false)\b/)) return 'number';
    if (stream.match(/^[A-Za-z_][\w-]*(?=\s*=)/)) return 'variableName';
    stream.next();
    return null;
  },
});

const colours = HighlightStyle.define([
  { tag: tags.keyword, color: 'var(--accent)', fontWeight: '600' },
  { tag: tags.comment, color: 'var(--soft)' },
  { tag: tags.string, color: 'var(--play)' },
  { tag: tags.number, color: 'var(--number)' },
]);

const look = EditorView.theme({
  '&': { height: '100%', fontSize: '12.5px', color: 'var(--ink)', backgroundColor: 'var(--panel)' },
  '.cm-scroller': { fontFamily: 'ui-monospace, "DejaVu Sans Mono", Menlo, Consolas, monospace', lineHeight: '1.5' },
  '.cm-gutters': { backgroundColor: 'var(--raised)', color: 'var(--soft)', border: 'none' },
  '.cm-activeLineGutter': { backgroundColor: 'transparent', color: 'var(--ink)' },
  '.cm-cursor': { borderLeftColor: 'var(--ink)' },
  '&.cm-focused .cm-selectionBackground, .cm-selectionBackground': { background: 'color-mix(in srgb, var(--accent) 28%, transparent) !important' },
  '.cm-runs': { backgroundColor: 'color-mix(in srgb, var(--accent) 16%, transparent)' },
  '.cm-tooltip': { backgroundColor: 'var(--panel)', color: 'var(--ink)', border: '1px solid var(--line)' },
});

const setRunning = StateEffect.define<number>();
const running = StateField.define<DecorationSet>({
  create: () => Decoration.none,
  update(marks, change) {
    for (const effect of change.effects)
      if (effect.is(setRunning)) {
        const { doc } = change.state;
        if (effect.value < 1 || effect.value > doc.lines) return Decoration.none;
        return Decoration.set([Decoration.line({ class: 'cm-runs' }).range(doc.line(effect.value).from)]);
      }
    return marks.map(change.changes);
  },
  provide: (field) => EditorView.decorations.from(field),
});

export interface EditorEvents {
  typed: (text: string) => void;
  save: () => void;
  /** Undo and redo of changes outside the history of the editor. */
  undone: () => void;
  redone: () => void;
}

/** A command of the editor that always handles its key. */
const done = (act: () => void) => () => {
  act();
  return true;
};

export class Editor {
  readonly #view: EditorView;
  /** The text with the line ends of its file. */
  #text: string;
  #running = 0;
  /** Whether the current change is not caused by typing. */
  #given = false;

  constructor(host: HTMLElement, language: 'toml' | { keywords: readonly string[] }, label: string, text: string, { typed, save, undone, redone }: EditorEvents) {
    this.#text = text;
    const extensions: Extension[] = [
      lineNumbers(),
      highlightActiveLineGutter(),
      history(),
      drawSelection(),
      lintGutter(),
      running,
      look,
      language === 'toml' ? toml : programLanguage(language.keywords),
      syntaxHighlighting(colours),
      keymap.of([
        { key: 'Mod-s', run: done(save), preventDefault: true },
        // The history of the page continues where that of the editor ends: it includes edits from before the editor was opened.
        { key: 'Mod-z', run: (view) => undo(view) || done(undone)(), preventDefault: true },
        { key: 'Mod-y', mac: 'Mod-Shift-z', run: (view) => redo(view) || done(redone)(), preventDefault: true },
        { linux: 'Ctrl-Shift-z', run: (view) => redo(view) || done(redone)(), preventDefault: true },
      ]),
      // Escape, then Tab leaves the editor by the keyboard.
      keymap.of([...defaultKeymap, ...historyKeymap, indentWithTab]),
      EditorView.contentAttributes.of({ 'aria-label': label, 'aria-description': 'Tab indents. Press Escape, then Tab to leave the editor.', spellcheck: 'false', tabindex: '0' }),
      EditorView.updateListener.of((update) => {
        if (!update.docChanged || this.#given) return;
        this.#text = withLineEnds(update.state.doc.toString(), this.#text);
        typed(this.#text);
      }),
    ];
    this.#view = new EditorView({ parent: host, state: EditorState.create({ doc: text, extensions }) });
  }

  destroy(): void {
    this.#view.destroy();
  }

  /** Replaces the text, changing only the part that differs. */
  set text(whole: string) {
    this.#text = whole;
    const text = withoutReturns(whole);
    const now = this.#view.state.doc.toString();
    if (now === text) return;
    let start = 0;
    const most = Math.min(now.length, text.length);
    while (start < most && now[start] === text[start]) start += 1;
    let end = 0;
    while (end < most - start && now[now.length - 1 - end] === text[text.length - 1 - end]) end += 1;
    this.#given = true;
    this.#view.dispatch({ changes: { from: start, to: now.length - end, insert: text.slice(start, text.length - end) }, annotations: Transaction.addToHistory.of(false) });
    this.#given = false;
  }

  set diagnostics(diagnostics: EditorDiagnostic[]) {
    const { doc } = this.#view.state;
    const found = diagnostics
      .filter(({ line }) => line >= 1 && line <= doc.lines)
      .map(({ line, column, width, message, severity }): Diagnostic => {
        const at = doc.line(line);
        const from = Math.min(at.from + Math.max(column - 1, 0), at.to);
        const to = Math.min(from + Math.max(width, 1), at.to);
        return { from: to > from ? from : at.from, to, severity, message };
      });
    this.#view.dispatch(setDiagnostics(this.#view.state, found));
  }

  /** Marks the executed line; 0 for none. */
  set running(line: number) {
    if (line === this.#running) return;
    this.#running = line;
    this.#view.dispatch({ effects: setRunning.of(line) });
  }

  /** Scrolls to a line. */
  show(line: number): void {
    const { doc } = this.#view.state;
    if (line < 1 || line > doc.lines) return;
    const at = doc.line(line).from;
    this.#view.dispatch({ selection: { anchor: at }, effects: EditorView.scrollIntoView(at, { y: 'center' }) });
  }
}
