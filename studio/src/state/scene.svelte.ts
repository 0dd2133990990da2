// The one viewer of the page, for whoever has to speak to it.

import type { Viewer } from '../scene/viewer';

class SceneHolder {
  viewer = $state.raw<Viewer | null>(null);
}

export const scene = new SceneHolder();
