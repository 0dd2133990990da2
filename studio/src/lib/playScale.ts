// Play scale on a logarithmic slider.

import { EXAGGERATION } from './document';
import { fixed } from './units';

/** Length of the slider. */
export const SLIDER = 1000;
const PER_E = SLIDER / Math.log(EXAGGERATION.max / EXAGGERATION.min);

/** A play scale within its limits. */
export const clampedScale = (value: number): number => Math.min(Math.max(value, EXAGGERATION.min), EXAGGERATION.max);

/** Largest gap around a ball that its bearing is drawn with [units of the scene]: it leaves a rim of the platform. */
export const LARGEST_GAP = 18.5;
/** Play scales of a robot that is opened, the largest first. */
const INITIAL_SCALES = [500, 200, 100, 50, 20, 10, 5, 2, 1];

/** The initial play scale of a robot: balls that are displaced that far [units of the scene] stay in their bearings. */
export const initialScale = (displacement: number): number => INITIAL_SCALES.find((scale) => scale * displacement <= LARGEST_GAP) ?? 1;

/** Position of a play scale on the slider. */
export const toSlider = (scale: number): number => PER_E * Math.log(scale / EXAGGERATION.min);

/** A play scale with two digits. */
export const roundedScale = (scale: number): number => clampedScale(Number(scale.toPrecision(2)));

/** The play scale at a position of the slider, rounded to two digits. */
export const fromSlider = (position: number): number => roundedScale(EXAGGERATION.min * Math.exp(position / PER_E));

/** A play scale as text, without its sign ×. */
export const scaleText = (scale: number): string => fixed(scale, scale < 10 && !Number.isInteger(scale) ? 1 : 0);
