import type { Theme } from '../scene/palette';

/** Line colors of plots, safe for color-blind users; lines also differ in their dashes. */
export const SERIES: Record<Theme, string[]> = {
  light: ['#0072b2', '#d55e00', '#009e73', '#a8447c', '#b87f00', '#2f8fc9'],
  dark: ['#56b4e9', '#ff9d4d', '#3fc79a', '#e39ac4', '#f0c04a', '#9ecdf0'],
};
