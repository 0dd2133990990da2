// The visible plots of the robot view, for export.

import type uPlot from 'uplot';
import type { PlotKind } from '../lib/figures';

export const plots = new Map<string, { plot: uPlot; kind: PlotKind }>();
