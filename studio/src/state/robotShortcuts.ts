// Keyboard shortcuts of the robot view.

import { EXAGGERATION, VIRTUALIZATIONS } from '../lib/document';
import { STANDARD_VIEWS, type StandardView } from '../scene/robotRenderer';
import { layout } from './layout.svelte';
import { plotLayout } from './plotLayout.svelte';
import { scene } from './scene.svelte';
import { shortcutOf, type ShortcutSheet, type Shortcut } from './shortcuts';
import { studio } from './studio.svelte';

const view = (side: StandardView) => () => scene.renderer?.look(side);
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
  { group: 'Motion', keys: [' '], description: 'play or pause', run: () => studio.player.toggle() },
  { group: 'Motion', keys: ['ArrowRight'], description: 'next sample', run: (event) => studio.player.step(event.shiftKey ? 10 : 1) },
  { group: 'Motion', keys: ['ArrowLeft'], description: 'previous sample (Shift: 10 samples)', run: (event) => studio.player.step(event.shiftKey ? -10 : -1) },
  { group: 'Motion', keys: ['Home'], description: 'first sample', run: () => studio.player.seek(0) },
  { group: 'Motion', keys: ['End'], description: 'last sample', run: () => studio.player.seek(studio.study.count - 1) },
  { group: 'Motion', keys: ['c'], description: 'reference of plot values here, or none', run: () => (plotLayout.reference = plotLayout.reference === studio.player.sample ? null : studio.player.sample) },
  { group: 'Motion', keys: ['l'], description: 'loop on or off', run: () => (studio.player.loop = !studio.player.loop) },
  { group: 'Robot', keys: ['i'], description: 'tilt by −0.1° about x', run: () => nudge(-0.1, 0, 0) },
  { group: 'Robot', keys: ['k'], description: 'tilt by +0.1° about x', run: () => nudge(0.1, 0, 0) },
  { group: 'Robot', keys: ['j'], description: 'tilt by −0.1° about y', run: () => nudge(0, -0.1, 0) },
  { group: 'Robot', keys: [';'], description: 'tilt by +0.1° about y', run: () => nudge(0, 0.1, 0) },
  { group: 'Robot', keys: ['PageUp'], description: 'up by 1 mm', run: () => nudge(0, 0, 1) },
  { group: 'Robot', keys: ['PageDown'], description: 'down by 1 mm', run: () => nudge(0, 0, -1) },
  { group: 'Robot', keys: ['0'], description: 'level', run: () => level() },
  { group: 'Play', keys: ['+', '='], description: 'increase play scale', run: () => exaggerate(1.25) },
  { group: 'Play', keys: ['-'], description: 'decrease play scale', run: () => exaggerate(0.8) },
  { group: 'Play', keys: ['m'], description: 'next virtualization', run: () => nextModel() },
  { group: 'Play', keys: ['v'], description: 'show or hide virtual joints', run: () => studio.setShown({ joints: !studio.document.shown.joints }) },
  { group: 'Play', keys: ['g'], description: 'show or hide the approximate model', run: () => studio.setShown({ ghost: !studio.document.shown.ghost }) },
  { group: 'Play', keys: ['x'], description: 'show or hide the platforms of the other models', run: () => studio.setShown({ others: !studio.document.shown.others }) },
  { group: 'Play', keys: ['a'], description: 'show or hide centre shifts', run: () => studio.setShown({ arrows: !studio.document.shown.arrows }) },
  { group: 'Play', keys: ['n'], description: 'show or hide labels', run: () => studio.setShown({ labels: !studio.document.shown.labels }) },
  ...sides.map((side, i): Shortcut => ({ group: 'View', keys: [String(i + 1)], description: `view: ${side}`, run: view(side) })),
  { group: 'View', keys: ['f'], description: 'fit the robot to the view', run: () => scene.renderer?.fit() },
  { group: 'View', keys: ['p'], description: 'close-up of the platform', run: () => scene.renderer?.lookAtPlatform() },
  { group: 'View', keys: ['o'], description: 'orthographic or perspective', run: () => scene.renderer?.toggleProjection() },
  { group: 'Page', keys: ['?'], description: 'keyboard shortcuts', run: () => (layout.helpOpen = !layout.helpOpen) },
  { group: 'Page', keys: ['e'], description: 'edit the robot', run: () => (layout.robotEditor = !layout.robotEditor) },
  { group: 'Page', keys: ['b'], description: 'show or hide panels', run: () => layout.toggleDocks() },
  { group: 'Page', keys: ['w'], description: 'why the models differ', run: () => (layout.explainOpen = !layout.explainOpen) },
  { group: 'Page', keys: ['t'], description: 'light or dark theme', run: () => studio.setTheme(studio.theme === 'dark' ? 'light' : 'dark') },
];

export const ROBOT_SHORTCUTS: ShortcutSheet = {
  view: 'robot view',
  shortcuts: SHORTCUTS,
  control: [
    { keys: ['Ctrl', 'Z'], description: 'undo' },
    { keys: ['Ctrl', 'Shift', 'Z'], description: 'redo' },
    { keys: ['Ctrl', 'S'], description: 'save the robot file' },
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
  const index = VIRTUALIZATIONS.indexOf(studio.document.model);
  studio.setModel(VIRTUALIZATIONS[(index + 1) % VIRTUALIZATIONS.length] as (typeof VIRTUALIZATIONS)[number]);
}

export function handleRobotShortcut(event: KeyboardEvent): void {
  if (!studio.robot || event.defaultPrevented || event.altKey) return;
  if (event.ctrlKey || event.metaKey) {
    const key = event.key.toLowerCase();
    if (key === 's' && layout.robotEditor) {
      event.preventDefault();
      if (studio.file.writable) void studio.file.save();
      return;
    }
    if (key !== 'z' && key !== 'y') return;
    event.preventDefault();
    if (key === 'y' || event.shiftKey) void studio.redo();
    else void studio.undo();
    return;
  }
  const found = shortcutOf(event, SHORTCUTS);
  if (!found) return;
  event.preventDefault();
  found.run(event);
}
