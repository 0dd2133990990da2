// How a reference is drawn in the view of mechanisms.

export const REFERENCE_DISPLAYS = { overlaid: 'Overlaid', separate: 'Side by side', hidden: 'Not drawn' } as const;
export type ReferenceDisplay = keyof typeof REFERENCE_DISPLAYS;

export const isReferenceDisplay = (value: unknown): value is ReferenceDisplay => typeof value === 'string' && Object.hasOwn(REFERENCE_DISPLAYS, value);

/** The next display, in the order of the choice. */
export function nextDisplay(display: ReferenceDisplay): ReferenceDisplay {
  const all = Object.keys(REFERENCE_DISPLAYS) as ReferenceDisplay[];
  return all[(all.indexOf(display) + 1) % all.length] as ReferenceDisplay;
}
