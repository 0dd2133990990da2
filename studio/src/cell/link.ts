// Links to the view of a cell: cell, time, selection, play scale and camera.

import { toCellHash, type CellLink } from '../lib/cellLink';
import { session } from './session.svelte';

const cellName = () => session.file ?? 'example';

/** Fragment of a URL that opens the view as it is. */
export function cellHash(): string {
  const { tab, instruction, selection, tools, view, camera } = session;
  const { time, range } = session.playback;
  return toCellHash({ cell: cellName(), time, tab, instruction, selected: selection.part, range, play: tools.playScale, camera: view?.cameraPose ?? camera });
}

/** Takes over the state of a link, once the motion is planned. */
export function openCellLink({ cell, time, tab, instruction, selected, range, play, camera }: CellLink): void {
  if (cell !== cellName()) session.notice = `This link was created with another cell, “${cell}”. Its time and selection may not apply to this cell.`;
  session.playback.pause();
  session.tab = tab;
  session.instruction = instruction;
  session.selection.part = selected;
  session.playback.show(range);
  session.tools.playScale = play;
  session.playback.seek(time);
  if (!camera) return;
  session.camera = camera;
  if (session.view) session.view.cameraPose = camera;
}
