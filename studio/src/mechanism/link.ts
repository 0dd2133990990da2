// Links to the view of mechanisms: mechanism, parameters, configuration, play scale, selection and camera.

import { packText, toMechanismHash, unpackText, type MechanismLink } from '../lib/mechanismLink';
import { MAX_BODY_BYTES } from '../lib/requestSize';
import { mechanismSession as session } from './session.svelte';

/** Fragment of a URL that opens the view as it is; the text is part of it, unless it is that of an entry of the catalogue. */
export async function mechanismHash(): Promise<string> {
  const { work, tab, selected, entries, view, camera } = session;
  const { configuration, playScale } = session.controller;
  const isEntry = entries.some(({ name, text }) => name === work.name && text === work.text);
  return toMechanismHash({
    name: work.name,
    packed: isEntry || work.text === '' ? null : await packText(work.text),
    parameters: work.parameters,
    coordinates: configuration?.coordinates ?? null,
    play: playScale,
    tab,
    selected,
    camera: view?.cameraPose ?? camera,
  });
}

/** Opens the mechanism of a link in its configuration. */
export async function openMechanismLink({ name, packed, parameters, coordinates, play, tab, selected, camera }: MechanismLink): Promise<void> {
  let text = session.entries.find((entry) => entry.name === name)?.text ?? null;
  if (packed !== null)
    try {
      text = await unpackText(packed, MAX_BODY_BYTES);
    } catch {
      session.notice = 'The text of the link is damaged: copy the link again.';
      return;
    }
  const isOpen = name === session.work.name && (text === null || text === session.work.text);
  if (!isOpen) {
    if (text === null) {
      session.notice = `The link refers to ${name}, which is not in the catalogue and not open: open the file first, then the link.`;
      return;
    }
    // Parameters and configuration of the link belong to its text.
    if (!(await session.open(name, text))) return;
  }
  await session.arrange(parameters, coordinates, play);
  session.tab = tab;
  session.selected = selected;
  session.camera = camera;
}
