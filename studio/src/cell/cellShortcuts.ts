// Keyboard shortcuts of the cell view.

import { layout } from '../state/layout.svelte';
import { shortcutOf, type ShortcutSheet, type Shortcut } from '../state/shortcuts';
import { studio } from '../state/studio.svelte';
import { session } from './session.svelte';
import { SCENE_VIEWS } from '../scene/standardViews';

/** Time steps of the arrow keys [s]. */
const STEP = { short: 0.04, long: 1 } as const;

const SHORTCUTS: Shortcut[] = [
  { group: 'Program', keys: [' '], description: 'play or pause', run: () => session.playback.toggle() },
  { group: 'Program', keys: ['ArrowRight'], description: 'forward by 0.04 s (Shift: 1 s)', run: ({ shiftKey }) => session.playback.seek(session.playback.time + (shiftKey ? STEP.long : STEP.short)) },
  { group: 'Program', keys: ['ArrowLeft'], description: 'back by 0.04 s (Shift: 1 s)', run: ({ shiftKey }) => session.playback.seek(session.playback.time - (shiftKey ? STEP.long : STEP.short)) },
  { group: 'Program', keys: ['Home'], description: 'start of the program', run: () => session.playback.seek(0) },
  { group: 'Program', keys: ['End'], description: 'end of the program', run: () => session.playback.seek(session.duration) },
  { group: 'Program', keys: ['l'], description: 'loop on or off', run: () => (session.playback.loop = !session.playback.loop) },
  ...SCENE_VIEWS.map(([view, title], i): Shortcut => ({ group: 'View', keys: [String(i + 1)], description: `view: ${title.toLowerCase()}`, run: () => session.view?.showView(view) })),
  { group: 'View', keys: ['h'], description: 'hide or show the selected part', run: () => session.selection.toggleHidden() },
  { group: 'View', keys: ['i'], description: 'isolate the selected part, or show all parts', run: () => session.selection.isolate() },
  { group: 'View', keys: ['f'], description: 'follow the selected part, or stop following', run: () => (session.tools.followed = session.tools.followed === null ? session.selection.part : null) },
  { group: 'View', keys: ['m'], description: 'measure the distance of two clicked points', run: () => session.tools.setMeasuring(!session.tools.measuring) },
  { group: 'View', keys: ['Escape'], description: 'end measuring and teaching by clicks', run: () => { session.tools.setMeasuring(false); session.tools.teaching = null; } },
  { group: 'View', keys: ['d'], description: 'show or hide the line of the minimum distance', run: () => (session.tools.nearestShown = !session.tools.nearestShown) },
  { group: 'Page', keys: ['?'], description: 'keyboard shortcuts', run: () => (layout.helpOpen = !layout.helpOpen) },
  { group: 'Page', keys: ['t'], description: 'light or dark theme', run: () => studio.setTheme(studio.theme === 'dark' ? 'light' : 'dark') },
];

export const CELL_SHORTCUTS: ShortcutSheet = {
  view: 'cell view',
  shortcuts: SHORTCUTS,
  control: [
    { keys: ['Ctrl', 'S'], description: 'save, also in the editor; of a cell that is not on the server, download the changed texts' },
    { keys: ['Ctrl', 'Z'], description: 'undo' },
    { keys: ['Ctrl', 'Shift', 'Z'], description: 'redo' },
    { keys: ['Esc', 'Tab'], description: 'leave the editor' },
  ],
  pointer: [
    'Drag with the left button to orbit, with the right button to pan; use the wheel to zoom. Click a part to select it. Drag the handles of the selected station to move it.',
    'Click in the axis chart to go to that time. Use the wheel to zoom the chart, Shift and the wheel to scroll it. Drag in the strip below the chart to choose the displayed time range.',
  ],
};

export function handleCellShortcut(event: KeyboardEvent): void {
  if (event.defaultPrevented || event.altKey) return;
  if (event.ctrlKey || event.metaKey) {
    const pressed = event.key.toLowerCase();
    if (pressed === 's') commitInputAndSave();
    else if ((event.target as HTMLElement).closest('.cm-editor, input:not([type=range]), select, textarea, dialog[open]')) return;
    else if (pressed === 'z' && !event.shiftKey) session.undo();
    else if (pressed === 'y' || pressed === 'z') session.redo();
    else return;
    event.preventDefault();
    return;
  }
  const found = shortcutOf(event, SHORTCUTS);
  if (!found) return;
  event.preventDefault();
  found.run(event);
}

/** Saves, after committing a number that is being typed. */
function commitInputAndSave(): void {
  const { activeElement } = document;
  if (activeElement instanceof HTMLInputElement) {
    activeElement.blur();
    activeElement.focus();
  }
  void session.save();
}
