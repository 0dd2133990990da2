// Keyboard shortcuts of a view: one table for key events and for the list of shortcuts.

export interface Shortcut {
  keys: string[];
  description: string;
  group: string;
  run: (event: KeyboardEvent) => void;
}

/** Contents of the list of shortcuts of a view. */
export interface ShortcutSheet {
  view: string;
  shortcuts: Shortcut[];
  /** Shortcuts with Ctrl. */
  control: { keys: string[]; description: string }[];
  /** Mouse actions, one paragraph each. */
  pointer: string[];
}

/** The shortcut of a key event, unless the focused element handles the key itself. */
export function shortcutOf(event: KeyboardEvent, shortcuts: Shortcut[]): Shortcut | undefined {
  const target = event.target as HTMLElement;
  const moving = /^(Arrow|Home|End|Page)/.test(event.key);
  const typing = target.closest('input:not([type=checkbox]), select, textarea, dialog[open], .cm-editor');
  // Sliders handle the arrow keys, buttons the space bar.
  if (typing && !(typing instanceof HTMLInputElement && typing.type === 'range' && !moving)) return undefined;
  if (target.closest('button, summary, [role=tab], [role=slider]') && (event.key === ' ' || event.key === 'Enter')) return undefined;
  if (target.closest('[role=tab], [role=slider], [role=separator]') && moving) return undefined;
  return shortcuts.find(({ keys }) => keys.includes(event.key) || keys.includes(event.key.toLowerCase()));
}
