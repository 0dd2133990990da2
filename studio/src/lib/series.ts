import type { Theme } from '../scene/palette';

/** Colours of lines in a plot, safe for the colour-blind and told apart by their dashes too. */
export const SERIES: Record<Theme, string[]> = {
  light: ['#0072b2', '#d55e00', '#009e73', '#a8447c', '#b87f00', '#2f8fc9'],
  dark: ['#56b4e9', '#ff9d4d', '#3fc79a', '#e39ac4', '#f0c04a', '#9ecdf0'],
};
