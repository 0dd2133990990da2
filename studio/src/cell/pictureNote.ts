// The note of an exported picture or film: what it shows, and what it does not.

import { scaleText } from '../lib/playScale';
import { clock, length, type LengthUnit } from '../lib/units';
import type { Section } from './viewTools.svelte';

/** The state of the cell view that a note describes. */
export interface NotedState {
  readonly playback: { readonly time: number };
  readonly loading: boolean;
  readonly outdated: boolean;
  readonly plan: { violations: number } | null;
  readonly jog: { active: boolean; outdated: boolean; document: { check: { violations: readonly unknown[] } } | null };
  readonly tools: { playScale: number; section: Section | null; hidden: ReadonlySet<string> };
}

const counted = (count: number, one: string): string => `${count} ${one}${count === 1 ? '' : 's'}`;

export function pictureNote({ playback: { time }, loading, outdated, plan, jog, tools }: NotedState, name: string, unit: LengthUnit): string {
  const { playScale, section, hidden } = tools;
  const when = jog.active ? 'jogged' : loading ? `${clock(time)}, motion not loaded` : clock(time);
  const violations = jog.active ? (jog.document?.check.violations.length ?? 0) : (plan?.violations ?? 0);
  const check = (jog.active ? jog.outdated : outdated) ? 'outdated check' : violations === 0 ? '' : jog.active ? counted(violations, 'violation') : `not safe to run: ${counted(violations, 'violation')}`;
  return [
    `${name}, ${when}`,
    playScale > 1 ? `play scale ${scaleText(playScale)}×` : '',
    section ? `section at ${section.axis} = ${length(section.at, unit, 0)}` : '',
    hidden.size > 0 ? `${counted(hidden.size, 'part')} hidden` : '',
    check,
  ]
    .filter(Boolean)
    .join(' · ');
}
