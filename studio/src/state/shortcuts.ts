// Keys of a view: one table, by which keys are taken and from which the help sheet is made.

export interface Shortcut {
  keys: string[];
  says: string;
  group: string;
  does: (event: KeyboardEvent) => void;
}

/** What the help sheet of a view lists. */
export interface ShortcutSheet {
  view: string;
  shortcuts: Shortcut[];
  /** Keys that are taken together with Ctrl. */
  control: { keys: string[]; says: string }[];
  /** Use of the pointer, a paragraph each. */
  pointer: string[];
}

/** The shortcut of a key, unless what has the focus takes the key itself. */
export function shortcutOf(event: KeyboardEvent, shortcuts: Shortcut[]): Shortcut | undefined {
  const target = event.target as HTMLElement;
  const moving = /^(Arrow|Home|End|Page)/.test(event.key);
  const typing = target.closest('input:not([type=checkbox]), select, textarea, dialog[open], .cm-editor');
  // Sliders take arrows, buttons take space: those keep what they have.
  if (typing && !(typing instanceof HTMLInputElement && typing.type === 'range' && !moving)) return undefined;
  if (target.closest('button, summary, [role=tab], [role=slider]') && (event.key === ' ' || event.key === 'Enter')) return undefined;
  if (target.closest('[role=tab], [role=slider], [role=separator]') && moving) return undefined;
  return shortcuts.find(({ keys }) => keys.includes(event.key) || keys.includes(event.key.toLowerCase()));
}
