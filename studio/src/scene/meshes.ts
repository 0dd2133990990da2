// Reads the mesh files of a robot. The loader of a format is fetched only if the robot uses it.

import { BufferGeometry, Group, Mesh, type Material, type Object3D } from 'three';

export type MeshFormat = 'stl' | 'obj' | 'gltf' | 'glb';

/** The shortest binary STL [bytes]. */
const STL_HEAD = 84;

/** The mesh in a file, in mm with z up; formats without materials get the given one. */
export async function loadMesh(format: MeshFormat, bytes: ArrayBuffer, material: Material): Promise<Object3D> {
  const mesh = await read(format, bytes, material);
  let triangles = 0;
  mesh.traverse((part) => {
    if (!(part instanceof Mesh)) return;
    part.castShadow = part.receiveShadow = true;
    triangles += triangleCount(part.geometry as BufferGeometry);
  });
  if (triangles === 0) throw new Error('the file has no triangles');
  return mesh;
}

async function read(format: MeshFormat, bytes: ArrayBuffer, material: Material): Promise<Object3D> {
  switch (format) {
    case 'stl': {
      // The loader of three.js reads a count beyond the end of shorter files.
      if (bytes.byteLength < STL_HEAD) throw new Error('the file has no triangles');
      const { STLLoader } = await import('three/examples/jsm/loaders/STLLoader.js');
      return new Mesh(new STLLoader().parse(bytes), material);
    }
    case 'obj': {
      const { OBJLoader } = await import('three/examples/jsm/loaders/OBJLoader.js');
      const mesh = new OBJLoader().parse(new TextDecoder().decode(bytes));
      mesh.traverse((part) => {
        if (part instanceof Mesh) part.material = material;
        // Lines and points of the file are not displayed.
        else if (part !== mesh && !(part instanceof Group)) part.visible = false;
      });
      return mesh;
    }
    default: {
      const { GLTFLoader } = await import('three/examples/jsm/loaders/GLTFLoader.js');
      const { scene } = await new GLTFLoader().parseAsync(bytes, '');
      // glTF is in metres and has y up.
      const rotated = new Group();
      rotated.rotation.x = Math.PI / 2;
      rotated.scale.setScalar(1000);
      rotated.add(scene);
      return rotated;
    }
  }
}

/** The number of triangles; coordinates that are not finite are an error. */
function triangleCount(geometry: BufferGeometry): number {
  const positions = geometry.getAttribute('position');
  if (!positions) return 0;
  for (let i = 0; i < positions.count; i++)
    if (!Number.isFinite(positions.getX(i) + positions.getY(i) + positions.getZ(i)))
      throw new Error(`vertex ${i + 1} has a coordinate that is not a finite number`);
  return Math.floor((geometry.index?.count ?? positions.count) / 3);
}
