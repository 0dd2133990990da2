// Opens texts of files in the view of their kind.

import type { RecentKind } from '../lib/recentFiles';
import { layout } from './layout.svelte';
import { studio } from './studio.svelte';

/** Why a file of a kind cannot be shown by this server; `null` if it can. */
export function viewProblem(kind: RecentKind, name: string): string | null {
  if (studio.robot?.cell) return null;
  if (kind === 'cell') return `${name} is a work cell, and this server was started without one: start \`jointplay studio ${name}\`.`;
  if (kind === 'program') return `${name} is a program of a work cell, and this server was started without one: start \`jointplay studio\` with the cell file of the program.`;
  return null;
}

/** Opens a model with the file that closes its loops, and shows it. */
export async function openModel(files: readonly File[]): Promise<void> {
  const { mechanismSession } = await import('../mechanism/session.svelte');
  // The view itself opens the mechanism of the server only.
  await mechanismSession.start(false);
  await mechanismSession.openFiles(files);
  layout.setPart('mechanism');
}

/** Opens a work cell with its program, and shows it. */
export async function openCell(name: string, cell: string, program: string): Promise<void> {
  const { session } = await import('../cell/session.svelte');
  await session.open(name, cell, program);
  layout.setPart('cell');
}

/** Opens a text in the view of its kind, and shows that view. */
export async function openInView(kind: RecentKind, name: string, text: string): Promise<void> {
  if (kind === 'three_rods') {
    await studio.file.open(name, text);
    layout.robotEditor = true;
    layout.setPart('robot');
  } else if (kind === 'cell') {
    await openCell(name, text, '');
  } else if (kind === 'program') {
    const { session } = await import('../cell/session.svelte');
    await session.openProgram(name, text);
    layout.setPart('cell');
  } else {
    const { mechanismSession } = await import('../mechanism/session.svelte');
    // The view itself opens the mechanism of the server only.
    await mechanismSession.start(false);
    await mechanismSession.open(name, text);
    layout.setPart('mechanism');
  }
}
