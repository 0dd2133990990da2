// Appearance of the parts of a cell, by the material of the server's document.

import { CylinderGeometry, DoubleSide, MeshPhysicalMaterial, MeshStandardMaterial, type BufferGeometry, type Mesh } from 'three';
import { mergeGeometries } from 'three/examples/jsm/utils/BufferGeometryUtils.js';
import { ZONE_COLORS } from './palette';
import { finished } from './solids';

/** Names of the materials in the document. */
export type CellMaterial = 'robot' | 'arm' | 'other arm' | 'wafer' | 'station' | 'body' | 'keep out' | 'safe';

/** Largest radius of a bevelled edge [m]. */
const BEVEL = 0.0015;
/** Half the angle of a slot mark, and its width [rad, m]. */
const MARK = { half: 0.32, width: 0.006, height: 0.0008 } as const;

/** Materials of all parts. */
export class CellMaterials {
  readonly robot = new MeshStandardMaterial({ color: 0xc3cad1, metalness: 0.85, roughness: 0.3 });
  readonly arm = new MeshStandardMaterial({ color: 0x3f7fbf, metalness: 0.45, roughness: 0.36 });
  readonly 'other arm' = new MeshStandardMaterial({ color: 0xd98a3d, metalness: 0.45, roughness: 0.36 });
  readonly wafer = new MeshStandardMaterial({ color: 0x9d95bd, metalness: 0.7, roughness: 0.2 });
  readonly station = new MeshStandardMaterial({ color: ZONE_COLORS.slot, metalness: 0.1, roughness: 0.6 });
  /** Bodies that reach above the lowest wafer of their station are transparent, because wafers are within. */
  readonly carrier = new MeshPhysicalMaterial({ color: 0x9fb4c6, metalness: 0, roughness: 0.14, transparent: true, opacity: 0.3, depthWrite: false });
  /** Bodies below the wafers of their station: supports, load ports, pedestals. */
  readonly pedestal = new MeshStandardMaterial({ color: 0xaab4be, metalness: 0.35, roughness: 0.45 });
  readonly body = new MeshStandardMaterial({ color: 0xd5dade, metalness: 0.25, roughness: 0.5 });
  /** A body between the viewer and the robot. */
  readonly obstructing = new MeshStandardMaterial({ color: 0xb9c2ca, metalness: 0.1, roughness: 0.5, transparent: true, opacity: 0.16, depthWrite: false });
  readonly 'keep out' = new MeshStandardMaterial({ color: ZONE_COLORS['keep out'], roughness: 0.9, transparent: true, opacity: 0.2, depthWrite: false, side: DoubleSide });
  readonly safe = new MeshStandardMaterial({ color: ZONE_COLORS.safe, roughness: 0.9, transparent: true, opacity: 0.14, depthWrite: false, side: DoubleSide });
  /** Surfaces that several parts share. */
  readonly #surfaces = new Map<BufferGeometry, BufferGeometry>();

  /** Gives a loaded part its surface and its material, and decides whether it casts shadows; `station` is where a body of a station is. */
  finish(mesh: Mesh, material: CellMaterial, station: 'around wafers' | 'below wafers' | null): void {
    const loaded = mesh.geometry;
    let surface = this.#surfaces.get(loaded);
    if (!surface) {
      surface = material === 'station' ? slotMark(loaded) : finished(loaded, BEVEL);
      this.#surfaces.set(loaded, surface);
      loaded.dispose();
    }
    mesh.geometry = surface;
    mesh.material = material !== 'body' || station === null ? this[material] : station === 'around wafers' ? this.carrier : this.pedestal;
    const solid = !['keep out', 'safe', 'station'].includes(material);
    mesh.castShadow = solid && mesh.material !== this.carrier;
    // Shadows of the wafers above would hide the slots of a carrier.
    mesh.receiveShadow = solid && material !== 'wafer';
    mesh.userData['onGround'] = solid;
  }

  /** Forgets the surfaces of the last cell. */
  clear(): void {
    for (const surface of this.#surfaces.values()) surface.dispose();
    this.#surfaces.clear();
  }

  dispose(): void {
    this.clear();
    for (const material of Object.values(this)) if (material instanceof MeshStandardMaterial) material.dispose();
  }
}

/** Two arcs at the edge of a wafer in its slot, in the plane of the loaded disk: a mark of a slot, not a body. */
function slotMark(disk: BufferGeometry): BufferGeometry {
  disk.computeBoundingBox();
  const { min, max } = disk.boundingBox!;
  const radius = (max.x - min.x) / 2;
  const arcs = [0, Math.PI].map((at) => {
    const outer = new CylinderGeometry(radius, radius, MARK.height, 12, 1, true, at + Math.PI / 2 - MARK.half, 2 * MARK.half);
    const top = ring(radius, at);
    return mergeGeometries([outer, top])!;
  });
  return mergeGeometries(arcs)!.rotateX(Math.PI / 2).translate(0, 0, (min.z + max.z) / 2);
}

/** The upper side of an arc, as a part of a flat cylinder wall that is nearly horizontal. */
function ring(radius: number, at: number): BufferGeometry {
  const inner = radius - MARK.width;
  return new CylinderGeometry(inner, radius, 1e-6, 12, 1, true, at + Math.PI / 2 - MARK.half, 2 * MARK.half).translate(0, MARK.height / 2, 0);
}
