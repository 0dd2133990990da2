// The keys of the robot's view.

import { EXAGGERATION, VIRTUALIZATIONS } from '../lib/document';
import { STANDARD_VIEWS, type StandardView } from '../scene/robotRenderer';
import { layout } from './layout.svelte';
import { scene } from './scene.svelte';
import { shortcutOf, type ShortcutSheet, type Shortcut } from './shortcuts';
import { studio } from './studio.svelte';

const view = (side: StandardView) => () => scene.viewer?.look(side);
const sides = Object.keys(STANDARD_VIEWS) as StandardView[];

function exaggerate(factor: number): void {
  const to = Math.min(Math.max(studio.document.exaggeration * factor, EXAGGERATION.min), EXAGGERATION.max);
  studio.exaggerate(Math.round(to));
  void studio.commit();
}

function nudge(x_deg: number, y_deg: number, height_mm: number): void {
  const from = studio.commandAs('tilt_xy');
  if (from?.kind !== 'tilt_xy') return;
  studio.jog({
    ...from,
    about_x_deg: from.about_x_deg + x_deg,
    about_y_deg: from.about_y_deg + y_deg,
    height_mm: from.height_mm + height_mm,
  });
  void studio.commit();
}

const SHORTCUTS: Shortcut[] = [
  { group: 'Motion', keys: [' '], says: 'play or pause', does: () => studio.player.toggle() },
  { group: 'Motion', keys: ['ArrowRight'], says: 'next sample', does: (event) => studio.player.step(event.shiftKey ? 10 : 1) },
  { group: 'Motion', keys: ['ArrowLeft'], says: 'previous sample (Shift: 10 samples)', does: (event) => studio.player.step(event.shiftKey ? -10 : -1) },
  { group: 'Motion', keys: ['Home'], says: 'first sample', does: () => studio.player.seek(0) },
  { group: 'Motion', keys: ['End'], says: 'last sample', does: () => studio.player.seek(studio.study.count - 1) },
  { group: 'Motion', keys: ['l'], says: 'loop on or off', does: () => (studio.player.loop = !studio.player.loop) },
  { group: 'Robot', keys: ['i'], says: 'tilt by −0.1° about x', does: () => nudge(-0.1, 0, 0) },
  { group: 'Robot', keys: ['k'], says: 'tilt by +0.1° about x', does: () => nudge(0.1, 0, 0) },
  { group: 'Robot', keys: ['j'], says: 'tilt by −0.1° about y', does: () => nudge(0, -0.1, 0) },
  { group: 'Robot', keys: [';'], says: 'tilt by +0.1° about y', does: () => nudge(0, 0.1, 0) },
  { group: 'Robot', keys: ['PageUp'], says: 'up by 1 mm', does: () => nudge(0, 0, 1) },
  { group: 'Robot', keys: ['PageDown'], says: 'down by 1 mm', does: () => nudge(0, 0, -1) },
  { group: 'Robot', keys: ['0'], says: 'level', does: () => level() },
  { group: 'Play', keys: ['+', '='], says: 'increase play scale', does: () => exaggerate(1.25) },
  { group: 'Play', keys: ['-'], says: 'decrease play scale', does: () => exaggerate(0.8) },
  { group: 'Play', keys: ['m'], says: 'next virtualization', does: () => nextModel() },
  { group: 'Play', keys: ['v'], says: 'show or hide virtual joints', does: () => studio.setShown({ joints: !studio.document.shown.joints }) },
  { group: 'Play', keys: ['g'], says: 'show or hide the approximate model', does: () => studio.setShown({ ghost: !studio.document.shown.ghost }) },
  { group: 'Play', keys: ['a'], says: 'show or hide centre shifts', does: () => studio.setShown({ arrows: !studio.document.shown.arrows }) },
  { group: 'Play', keys: ['n'], says: 'show or hide labels', does: () => studio.setShown({ labels: !studio.document.shown.labels }) },
  ...sides.map((side, i): Shortcut => ({ group: 'View', keys: [String(i + 1)], says: `view: ${side}`, does: view(side) })),
  { group: 'View', keys: ['f'], says: 'fit the robot to the view', does: () => scene.viewer?.fit() },
  { group: 'View', keys: ['p'], says: 'close-up of the platform', does: () => scene.viewer?.lookAtPlatform() },
  { group: 'View', keys: ['o'], says: 'orthographic or perspective', does: () => scene.viewer?.toggleProjection() },
  { group: 'Page', keys: ['?'], says: 'keyboard shortcuts', does: () => (layout.helpOpen = !layout.helpOpen) },
  { group: 'Page', keys: ['b'], says: 'show or hide panels', does: () => layout.toggleDocks() },
  { group: 'Page', keys: ['w'], says: 'why the models differ', does: () => (layout.explainOpen = !layout.explainOpen) },
  { group: 'Page', keys: ['t'], says: 'light or dark theme', does: () => studio.setTheme(studio.theme === 'dark' ? 'light' : 'dark') },
];

export const ROBOT_SHORTCUTS: ShortcutSheet = {
  view: 'robot view',
  shortcuts: SHORTCUTS,
  control: [
    { keys: ['Ctrl', 'Z'], says: 'undo' },
    { keys: ['Ctrl', 'Shift', 'Z'], says: 'redo' },
  ],
  pointer: [
    'Drag a panel by its grip to reorder it or to move it to the other side. Drag the edges of panels and plots to resize them.',
    'Drag with the left button to orbit, with the right button to pan; use the wheel to zoom. Double-click a part to center it. Drag a blue handle to tilt or lift the platform: 90 pixels correspond to one degree.',
  ],
};

function level(): void {
  const from = studio.commandAs('tilt_xy');
  if (from?.kind !== 'tilt_xy') return;
  studio.jog({ ...from, about_x_deg: 0, about_y_deg: 0 });
  void studio.commit();
}

function nextModel(): void {
  const at = VIRTUALIZATIONS.indexOf(studio.document.model);
  studio.setModel(VIRTUALIZATIONS[(at + 1) % VIRTUALIZATIONS.length] as (typeof VIRTUALIZATIONS)[number]);
}

export function handleRobotShortcut(event: KeyboardEvent): void {
  if (!studio.robot || event.defaultPrevented || event.altKey) return;
  if (event.ctrlKey || event.metaKey) {
    const key = event.key.toLowerCase();
    if (key !== 'z' && key !== 'y') return;
    event.preventDefault();
    if (key === 'y' || event.shiftKey) void studio.redo();
    else void studio.undo();
    return;
  }
  const found = shortcutOf(event, SHORTCUTS);
  if (!found) return;
  event.preventDefault();
  found.does(event);
}
