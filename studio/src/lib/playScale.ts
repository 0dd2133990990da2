// Play scale on a logarithmic slider.

import { EXAGGERATION } from './document';
import { fixed } from './units';

/** Length of the slider. */
export const SLIDER = 1000;
const PER_E = SLIDER / Math.log(EXAGGERATION.max / EXAGGERATION.min);

/** A play scale within its limits. */
export const clampedScale = (value: number): number => Math.min(Math.max(value, EXAGGERATION.min), EXAGGERATION.max);

/** Position of a play scale on the slider. */
export const toSlider = (scale: number): number => PER_E * Math.log(scale / EXAGGERATION.min);

/** The play scale at a position of the slider, rounded to two digits. */
export const fromSlider = (position: number): number => clampedScale(Number((EXAGGERATION.min * Math.exp(position / PER_E)).toPrecision(2)));

/** A play scale as text, without its sign ×. */
export const scaleText = (scale: number): string => fixed(scale, scale < 10 && !Number.isInteger(scale) ? 1 : 0);
