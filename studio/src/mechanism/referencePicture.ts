// The picture of a reference: translucent over the shown mechanism, or in a pane of its own next to it.

import { Box3, Vector3, type Scene } from 'three';
import type { MechanismDocument, PlacedDocument } from '../api/client';
import { SCENE, type Theme } from '../scene/palette';
import { Stage, type Grid } from '../scene/stage';
import type { ReferenceDisplay } from './referenceDisplay';
import { MechanismMaterials, MechanismModel, type PartOf } from './mechanismModel';

/** A state to compare with, and how it is drawn. */
export interface DrawnReference {
  document: MechanismDocument;
  poses: readonly PlacedDocument[];
  display: Exclude<ReferenceDisplay, 'hidden'>;
}

export class ReferencePicture {
  /** The stage of a pane of its own. */
  readonly stage: Stage;
  readonly #overlaid = new MechanismMaterials();
  #drawn: DrawnReference | null = null;
  #model: MechanismModel | null = null;

  constructor(grid: Grid) {
    this.stage = new Stage(grid);
  }

  dispose(): void {
    this.#clear();
    this.#overlaid.dispose();
    this.stage.dispose();
  }

  #clear(): void {
    if (!this.#model) return;
    this.#model.group.removeFromParent();
    this.#model.dispose();
    this.#model = null;
  }

  paint(theme: Theme): void {
    this.#overlaid.makeGhost(SCENE[theme].reference);
    this.stage.paint(theme);
  }

  /** Draws another reference: over `shown`, or on its own stage with the materials of a mechanism. */
  draw(drawn: DrawnReference | null, shown: Scene, materials: MechanismMaterials): void {
    this.#clear();
    this.#drawn = drawn;
    if (!drawn) return;
    const separate = drawn.display === 'separate';
    this.#model = new MechanismModel(drawn.document, separate ? materials : this.#overlaid);
    this.#model.place(drawn.poses);
    if (!separate) this.#model.group.traverse((part) => (part.castShadow = false));
    (separate ? this.stage.scene : shown).add(this.#model.group);
  }

  get drawn(): DrawnReference | null {
    return this.#drawn;
  }

  /** The reference in a pane of its own; `null` if there is none. */
  get separate(): { document: MechanismDocument; model: MechanismModel } | null {
    return this.#drawn?.display === 'separate' && this.#model ? { document: this.#drawn.document, model: this.#model } : null;
  }

  get box(): Box3 {
    return this.#model?.box ?? new Box3();
  }

  /**
   * Scales the reference to a unit of the scene [m], and places it in its own pane: an earlier state of a mechanism at its place
   * in the base frame, and another mechanism with its centre at that of the shown one.
   */
  arrange(unit_m: number, shown: Box3, isSameMechanism: boolean): void {
    const group = this.#model?.group;
    if (!group) return;
    group.scale.setScalar(1 / unit_m);
    group.position.set(0, 0, 0);
    if (this.separate && !isSameMechanism) group.position.copy(shown.getCenter(new Vector3()).sub(this.box.getCenter(new Vector3())));
    this.stage.partsMoved();
  }

  drawCoarsely(isCoarse: boolean): void {
    this.#model?.drawCoarsely(isCoarse);
  }

  /** Highlights parts in its own pane. */
  highlight(selected: (part: PartOf) => boolean): void {
    this.separate?.model.highlight(selected);
  }
}
