// A scene with its lights, its ground and its shadows. A view renders one stage, or several next to each other.

import { DirectionalLight, Scene, Vector3, type Box3, type WebGLRenderer } from 'three';
import { environmentLight } from './environment';
import { Ground } from './ground';
import { SCENE, type Theme } from './palette';

/** Direction to the key light. */
const KEY_LIGHT = new Vector3(0.31, -0.424, 0.851);
/** Intensities of the key light and of the environment. */
const INTENSITY = { key: 1.9, environment: 0.62 } as const;
/** Pixels of the shadow map along an edge, and the radius over which shadows are soft [pixels of the map]. */
const SHADOW = { pixels: 1024, radius: 2.4 } as const;

/** In drafts, the soft shadow on the ground follows every so many movements. */
const DRAFTS = 3;

/** Distance of the lines of the ground grid, and the radius in which they fade [units of the scene]. */
export interface Grid {
  step: number;
  radius: number;
}

export class Stage {
  readonly scene = new Scene();
  readonly #keyLight = new DirectionalLight(0xffffff);
  readonly #environment = environmentLight();
  readonly #ground: Ground;
  #shadowsOutdated = true;
  /** Number of movements since the shadow on the ground was rendered. */
  #movements = DRAFTS;
  #surfaces = 0;

  constructor(grid: Grid) {
    const light = this.#keyLight;
    light.castShadow = true;
    light.shadow.mapSize.set(SHADOW.pixels, SHADOW.pixels);
    light.shadow.radius = SHADOW.radius;
    this.#ground = new Ground(grid.step, grid.radius);
    this.scene.add(light, light.target, this.#environment, this.#ground.mesh);
  }

  dispose(): void {
    this.#ground.dispose();
    this.#keyLight.dispose();
  }

  /** Places ground and key light for a scene within a box. */
  place(box: Box3, floor: number): void {
    this.#ground.place(box, floor);
    const center = box.getCenter(new Vector3());
    const reach = 0.5 * box.getSize(new Vector3()).length();
    const light = this.#keyLight;
    light.target.position.copy(center);
    light.position.copy(center).addScaledVector(KEY_LIGHT, 2 * reach);
    Object.assign(light.shadow.camera, { left: -reach, right: reach, top: reach, bottom: -reach, near: 0.8 * reach, far: 3.2 * reach });
    light.shadow.camera.updateProjectionMatrix();
    // A part does not cast a shadow on itself within one pixel of the map.
    light.shadow.normalBias = (3 * reach) / SHADOW.pixels;
    this.partsMoved();
    this.#movements = DRAFTS;
  }

  /** Has the shadows rendered again before the next frame: they depend on the parts, not on the camera. */
  partsMoved(): void {
    this.#shadowsOutdated = true;
    this.#movements += 1;
    this.surfacesChanged();
  }

  /** Number of changes of the visible surfaces: what was computed for another one is outdated. */
  get surfaces(): number {
    return this.#surfaces;
  }

  /** Notes that parts have moved, or are cut, hidden or transparent now. */
  surfacesChanged(): void {
    this.#surfaces += 1;
  }

  paint(theme: Theme): void {
    const colours = SCENE[theme];
    this.#keyLight.intensity = INTENSITY.key * colours.light;
    this.#environment.intensity = INTENSITY.environment * colours.light;
    this.#ground.paint(colours.grid, colours.shadow);
  }

  /** Renders the shadow on the ground after parts have moved, in a draft not each time, and requests that of the key light for the next frame. */
  updateShadows(renderer: WebGLRenderer, isDraft: boolean): void {
    renderer.shadowMap.needsUpdate = this.#shadowsOutdated;
    this.#shadowsOutdated = false;
    if (this.#movements < (isDraft ? DRAFTS : 1)) return;
    this.#movements = 0;
    this.#ground.cast(renderer, this.scene);
  }
}
