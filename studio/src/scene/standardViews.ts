// Standard views of scenes with z up.

/** Direction from the scene to the viewer. */
export const STANDARD_VIEWS = { home: [-0.75, -1, 0.9], top: [0, -1e-3, 1], front: [0, -1, 0.12], left: [-1, 0, 0.12] } as const;
export type SceneView = keyof typeof STANDARD_VIEWS;
/** Standard views with their titles, in the order of their buttons and shortcuts. */
export const SCENE_VIEWS: [SceneView, string][] = [['home', 'Fit'], ['top', 'Top'], ['front', 'Front'], ['left', 'Left']];

/** Sides of the view cube, with the direction from the scene to the viewer. */
export const CUBE_SIDES = { front: [0, -1, 0], back: [0, 1, 0], left: [-1, 0, 0], right: [1, 0, 0], top: [0, -1e-4, 1], bottom: [0, -1e-4, -1] } as const;
export type CubeSide = keyof typeof CUBE_SIDES;
