// Shapes that the robot file names. Each format's reader is fetched only where such a shape is.

import { BufferGeometry, Group, Mesh, MeshStandardMaterial, type Material, type Object3D } from 'three';

export type MeshFormat = 'stl' | 'obj' | 'gltf' | 'glb';

const MOST_METAL = 0.2;
/** The shortest binary STL [bytes]. */
const STL_HEAD = 84;

/** The shape in a file, in mm and with z up; where the file tells no colours, in the given material. */
export async function loadMesh(format: MeshFormat, bytes: ArrayBuffer, material: Material): Promise<Object3D> {
  const shape = await read(format, bytes, material);
  let triangles = 0;
  shape.traverse((part) => {
    if (!(part instanceof Mesh)) return;
    part.castShadow = part.receiveShadow = true;
    triangles += check(part.geometry as BufferGeometry);
  });
  if (triangles === 0) throw new Error('the file has no triangles');
  return shape;
}

async function read(format: MeshFormat, bytes: ArrayBuffer, material: Material): Promise<Object3D> {
  switch (format) {
    case 'stl': {
      // Three asks shorter files for a count that lies behind their end.
      if (bytes.byteLength < STL_HEAD) throw new Error('the file has no triangles');
      const { STLLoader } = await import('three/examples/jsm/loaders/STLLoader.js');
      return new Mesh(new STLLoader().parse(bytes), material);
    }
    case 'obj': {
      const { OBJLoader } = await import('three/examples/jsm/loaders/OBJLoader.js');
      const shape = new OBJLoader().parse(new TextDecoder().decode(bytes));
      shape.traverse((part) => {
        if (part instanceof Mesh) part.material = material;
        // Lines and points of a drawing are no body.
        else if (part !== shape && !(part instanceof Group)) part.visible = false;
      });
      return shape;
    }
    default: {
      const { GLTFLoader } = await import('three/examples/jsm/loaders/GLTFLoader.js');
      const { scene } = await new GLTFLoader().parseAsync(bytes, '');
      // glTF is in metres and has y up.
      scene.traverse((part) => {
        if (!(part instanceof Mesh)) return;
        // Metal shows what surrounds it, and here nothing does: it would be black.
        for (const own of [part.material].flat()) if (own instanceof MeshStandardMaterial) own.metalness = Math.min(own.metalness, MOST_METAL);
      });
      const turned = new Group();
      turned.rotation.x = Math.PI / 2;
      turned.scale.setScalar(1000);
      turned.add(scene);
      return turned;
    }
  }
}

/** How many triangles there are; numbers that are none are an error, since nothing could be drawn of them. */
function check(geometry: BufferGeometry): number {
  const positions = geometry.getAttribute('position');
  if (!positions) return 0;
  for (let i = 0; i < positions.count; i++)
    if (!Number.isFinite(positions.getX(i) + positions.getY(i) + positions.getZ(i)))
      throw new Error(`vertex ${i + 1} has a coordinate that is not a finite number`);
  return Math.floor((geometry.index?.count ?? positions.count) / 3);
}
