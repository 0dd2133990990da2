// Release of the resources of 3D objects.

import { Mesh, type Material, type Object3D } from 'three';

/** Disposes of the geometries of an object and of all its children. */
export function disposeGeometries(object: Object3D): void {
  object.traverse((part) => {
    if (part instanceof Mesh) part.geometry.dispose();
  });
}

/** Disposes of one or several materials. */
export function disposeMaterials(materials: Material | Material[]): void {
  for (const material of [materials].flat()) material.dispose();
}
