// Keyboard shortcuts of the view of mechanisms.

import { SCENE_VIEWS, type SceneView } from '../scene/standardViews';
import { layout } from '../state/layout.svelte';
import { shortcutOf, type Shortcut, type ShortcutSheet } from '../state/shortcuts';
import { studio } from '../state/studio.svelte';
import { comparison } from './comparison.svelte';
import { nextDisplay } from './referenceDisplay';
import { mechanismSession } from './session.svelte';

/** Shows a standard view, while there is a 3D view. */
export const camera: { showView: ((view: SceneView) => void) | null } = { showView: null };

const SHORTCUTS: Shortcut[] = [
  { group: 'Mechanism', keys: ['h'], description: 'home: closed from the guess of the file', run: () => mechanismSession.home() },
  { group: 'Mechanism', keys: ['w'], description: 'animate instantaneous motions, or stop', run: () => (mechanismSession.controller.animated === null ? void mechanismSession.analyses.computeMotions() : (mechanismSession.controller.animated = null)) },
  { group: 'Mechanism', keys: ['c'], description: 'reference: compare with the shown state', run: () => comparison.take() },
  { group: 'Mechanism', keys: ['b'], description: 'reference overlaid, side by side or not drawn', run: () => comparison.setDisplay(nextDisplay(comparison.display)) },
  { group: 'Mechanism', keys: ['Escape'], description: 'end the selection and the animation', run: () => { mechanismSession.selected = null; mechanismSession.redundant = null; mechanismSession.controller.animated = null; } },
  ...SCENE_VIEWS.map(([view, title], i): Shortcut => ({ group: 'View', keys: [String(i + 1)], description: `view: ${title.toLowerCase()}`, run: () => camera.showView?.(view) })),
  { group: 'Page', keys: ['?'], description: 'keyboard shortcuts', run: () => (layout.helpOpen = !layout.helpOpen) },
  { group: 'Page', keys: ['t'], description: 'light or dark theme', run: () => studio.setTheme(studio.theme === 'dark' ? 'light' : 'dark') },
];

export const MECHANISM_SHORTCUTS: ShortcutSheet = {
  view: 'mechanism view',
  shortcuts: SHORTCUTS,
  control: [
    { keys: ['Ctrl', 'S'], description: 'save, or download a text without a file' },
    { keys: ['Ctrl', 'Z'], description: 'undo' },
    { keys: ['Ctrl', 'Shift', 'Z'], description: 'redo' },
    { keys: ['Esc', 'Tab'], description: 'leave the editor' },
  ],
  pointer: [
    'Drag the background to orbit, with the right button to pan; use the wheel to zoom. Click a link or joint to select it.',
    'Drag a link: its point follows the pointer as far as joints and limits allow. A selected link has a handle.',
    'Drop a file on the view to open it: a mechanism file, or a model with the file that closes its loops.',
  ],
};

export function handleMechanismShortcut(event: KeyboardEvent): void {
  if (event.defaultPrevented || event.altKey) return;
  if (event.ctrlKey || event.metaKey) {
    const pressed = event.key.toLowerCase();
    if (pressed === 's') void mechanismSession.save();
    else if ((event.target as HTMLElement).closest('.cm-editor, input:not([type=range]), select, textarea, dialog[open]')) return;
    else if (pressed === 'z' && !event.shiftKey) mechanismSession.undo();
    else if (pressed === 'y' || pressed === 'z') mechanismSession.redo();
    else return;
    event.preventDefault();
    return;
  }
  const found = shortcutOf(event, SHORTCUTS);
  if (!found) return;
  event.preventDefault();
  found.run(event);
}
