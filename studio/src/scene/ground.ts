// The ground below a scene: a grid that fades out, and the shadow of all parts above it, soft with their height.
//
// The shadow is a picture from below, blurred and kept until parts move: a frame costs one texture sample.

import {
  Color,
  DoubleSide,
  Mesh,
  OrthographicCamera,
  PlaneGeometry,
  RedFormat,
  Scene,
  ShaderMaterial,
  Vector2,
  Vector3,
  WebGLRenderTarget,
  type Box3,
  type WebGLRenderer,
} from 'three';

/** Pixels of the shadow along an edge. */
const PIXELS = 256;
/** The layer of the parts that cast shadows. */
const CASTERS = 1;

/** Darkness by the height above the ground: the lowest surface counts. */
const heightMaterial = () =>
  new ShaderMaterial({
    side: DoubleSide,
    vertexShader: /* glsl */ `
      varying float height;
      void main() {
        vec4 local = vec4( position, 1.0 );
        #ifdef USE_INSTANCING
          local = instanceMatrix * local;
        #endif
        gl_Position = projectionMatrix * modelViewMatrix * local;
        height = 0.5 + 0.5 * gl_Position.z / gl_Position.w;
      }`,
    fragmentShader: /* glsl */ `
      varying float height;
      void main() {
        float near = 1.0 - height;
        gl_FragColor = vec4( near * sqrt( near ), 0.0, 0.0, 1.0 );
      }`,
  });

const blurMaterial = () =>
  new ShaderMaterial({
    depthTest: false,
    depthWrite: false,
    uniforms: { picture: { value: null }, stride: { value: new Vector2() } },
    vertexShader: /* glsl */ `
      varying vec2 at;
      void main() { at = uv; gl_Position = vec4( position.xy * 2.0, 0.0, 1.0 ); }`,
    fragmentShader: /* glsl */ `
      uniform sampler2D picture;
      uniform vec2 stride;
      varying vec2 at;
      void main() {
        float sum = 0.2041636 * texture2D( picture, at ).r;
        sum += 0.3041783 * ( texture2D( picture, at + 1.4072930 * stride ).r + texture2D( picture, at - 1.4072930 * stride ).r );
        sum += 0.0937399 * ( texture2D( picture, at + 3.2942150 * stride ).r + texture2D( picture, at - 3.2942150 * stride ).r );
        gl_FragColor = vec4( sum, 0.0, 0.0, 1.0 );
      }`,
  });

const groundMaterial = (step: number, radius: number) =>
  new ShaderMaterial({
    transparent: true,
    depthWrite: false,
    side: DoubleSide,
    toneMapped: false,
    uniforms: {
      picture: { value: null },
      /** Origin and edge length of the shadow. */
      origin: { value: new Vector2() },
      extent: { value: 1 },
      darkness: { value: 0 },
      grid: { value: new Color() },
      spacing: { value: step },
      center: { value: new Vector2() },
      radius: { value: radius },
    },
    vertexShader: /* glsl */ `
      varying vec2 at;
      void main() {
        vec4 world = modelMatrix * vec4( position, 1.0 );
        at = world.xy;
        gl_Position = projectionMatrix * viewMatrix * world;
      }`,
    fragmentShader: /* glsl */ `
      uniform sampler2D picture;
      uniform vec2 origin, center;
      uniform float extent, darkness, spacing, radius;
      uniform vec3 grid;
      varying vec2 at;
      // Lines that are closer than pixels become an even gray instead of a moire.
      float lines( vec2 where ) {
        vec2 width = fwidth( where );
        vec2 off = abs( fract( where - 0.5 ) - 0.5 );
        vec2 line = ( 1.0 - smoothstep( 0.4 * width, 1.4 * width, off ) ) * ( 1.0 - smoothstep( 0.2, 0.5, width ) );
        return max( line.x, line.y );
      }
      // The shadow fades at the edges of its picture.
      float inside( vec2 p ) {
        vec2 q = smoothstep( vec2( 0.0 ), vec2( 0.04 ), p ) * smoothstep( vec2( 0.0 ), vec2( 0.04 ), 1.0 - p );
        return q.x * q.y;
      }
      void main() {
        float beyond = length( at - center ) / radius;
        if ( beyond >= 1.0 ) discard;
        float fade = 1.0 - smoothstep( 0.3, 1.0, beyond );
        float line = fade * max( 0.5 * lines( at / spacing ), lines( at / ( 5.0 * spacing ) ) );
        vec2 within = ( at - origin ) / extent;
        float shade = gl_FrontFacing ? darkness * inside( within ) * texture2D( picture, within ).r : 0.0;
        float alpha = 1.0 - ( 1.0 - shade ) * ( 1.0 - line );
        gl_FragColor = vec4( grid * line * ( 1.0 - shade ) / max( alpha, 1e-4 ), alpha );
        #include <colorspace_fragment>
      }`,
  });

/** The ground, and the shadow on it. */
export class Ground {
  readonly mesh: Mesh<PlaneGeometry, ShaderMaterial>;
  readonly #camera = new OrthographicCamera();
  readonly #height = heightMaterial();
  readonly #blur = blurMaterial();
  readonly #flat = new Mesh(new PlaneGeometry(1, 1), this.#blur);
  readonly #stage = new Scene();
  readonly #targets = [0, 1].map(() => new WebGLRenderTarget(PIXELS, PIXELS, { format: RedFormat }));

  /** A ground with lines at a distance and up to a radius [units of the scene]. */
  constructor(step: number, radius: number) {
    this.mesh = new Mesh(new PlaneGeometry(2 * radius, 2 * radius), groundMaterial(step, radius));
    this.mesh.renderOrder = -1;
    this.#flat.frustumCulled = false;
    this.#flat.layers.set(CASTERS);
    this.#stage.add(this.#flat);
    this.#camera.layers.set(CASTERS);
  }

  dispose(): void {
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
    this.#flat.geometry.dispose();
    this.#height.dispose();
    this.#blur.dispose();
    for (const target of this.#targets) target.dispose();
  }

  /** Colors of the grid and of the shadow. */
  paint(grid: number, darkness: number): void {
    this.mesh.material.uniforms['grid']!.value.set(grid);
    this.mesh.material.uniforms['darkness']!.value = darkness;
  }

  /** Places the ground below a box, whose shadow it shows up to a margin. */
  place(box: Box3, floor: number): void {
    const center = box.getCenter(new Vector3());
    const half = 0.5 * Math.max(box.max.x - box.min.x, box.max.y - box.min.y, 1e-6) * 1.5 + 0.12 * (box.max.z - floor);
    this.mesh.position.set(center.x, center.y, floor);
    const { uniforms } = this.mesh.material;
    (uniforms['center']!.value as Vector2).set(center.x, center.y);
    (uniforms['origin']!.value as Vector2).set(center.x - half, center.y - half);
    uniforms['extent']!.value = 2 * half;
    // The camera looks up, with x to the right and y up in the picture as seen from above: mirrored.
    const camera = this.#camera;
    Object.assign(camera, { left: half, right: -half, top: half, bottom: -half, near: 0, far: Math.max(box.max.z - floor, 1e-6) });
    camera.position.set(center.x, center.y, floor);
    camera.up.set(0, 1, 0);
    camera.lookAt(center.x, center.y, floor + 1);
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
  }

  /** Renders the shadow of the parts of a scene that cast one. */
  cast(renderer: WebGLRenderer, scene: Scene): void {
    scene.traverse((part) => {
      // Transparent parts darken the ground, but not the parts within.
      if (!(part instanceof Mesh)) return;
      // Hidden parts are in another layer.
      if (part.layers.isEnabled(0) && (part.castShadow || part.userData['onGround'])) part.layers.enable(CASTERS);
      else part.layers.disable(CASTERS);
    });
    const [first, second] = this.#targets as [WebGLRenderTarget, WebGLRenderTarget];
    const before = { color: renderer.getClearColor(new Color()), alpha: renderer.getClearAlpha(), shadows: renderer.shadowMap.needsUpdate };
    renderer.shadowMap.needsUpdate = false;
    renderer.setClearColor(0x000000, 0);
    scene.overrideMaterial = this.#height;
    renderer.setRenderTarget(first);
    renderer.clear();
    renderer.render(scene, this.#camera);
    scene.overrideMaterial = null;
    const { uniforms } = this.#blur;
    for (const width of [1.2, 2.2, 3.4])
      for (const [source, target, x, y] of [[first, second, width, 0], [second, first, 0, width]] as const) {
        uniforms['picture']!.value = source.texture;
        (uniforms['stride']!.value as Vector2).set(x / PIXELS, y / PIXELS);
        renderer.setRenderTarget(target);
        renderer.render(this.#stage, this.#camera);
      }
    renderer.setRenderTarget(null);
    renderer.setClearColor(before.color, before.alpha);
    renderer.shadowMap.needsUpdate = before.shadows;
    this.mesh.material.uniforms['picture']!.value = first.texture;
  }
}
