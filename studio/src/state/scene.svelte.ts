// The one viewer of the page, for whoever has to speak to it.

import type { RobotRenderer } from '../scene/robotRenderer';

class SceneHolder {
  viewer = $state.raw<RobotRenderer | null>(null);
}

export const scene = new SceneHolder();
