// The plots on the page at the moment, to be taken away.

import type uPlot from 'uplot';
import type { PlotKind } from '../lib/figures';

export const plots = new Map<string, { plot: uPlot; kind: PlotKind }>();
