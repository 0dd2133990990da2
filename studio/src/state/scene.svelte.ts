// The renderer of the robot view, shared by shortcuts, panels and export.

import type { RobotRenderer } from '../scene/robotRenderer';

class RobotScene {
  renderer = $state.raw<RobotRenderer | null>(null);
}

export const scene = new RobotScene();
