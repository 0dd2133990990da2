// The visible plots of the robot view, for export.

import type { Drawing } from '../lib/plotsvg';

/** Functions that draw the visible plots in their present ranges, by plot. */
export const plots = new Map<string, () => Drawing>();
