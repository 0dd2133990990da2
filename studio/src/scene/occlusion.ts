// Ambient occlusion: the share of the environment that the surroundings of a visible point leave free.
//
// A pass of its own computes it from the depths of the opaque parts, by the horizons in a few directions on the screen; the materials then
// dim the environment by it, and not the key light. Transparent parts, lines, handles and the background are neither dimmed nor dim others.
// Without a graphics card it takes as long as some frames: it is computed for pictures at rest and for export. While only colours change,
// the last one remains valid.

import {
  DepthTexture,
  DoubleSide,
  HalfFloatType,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  MeshStandardMaterial,
  NearestFilter,
  PlaneGeometry,
  RGFormat,
  Scene,
  ShaderMaterial,
  UnsignedIntType,
  Vector2,
  Vector4,
  WebGLRenderTarget,
  type Camera,
  type WebGLRenderer,
} from 'three';
import type { Box } from '../lib/labelLayout';
import { occlusionUniforms } from './environment';
import type { Stage } from './stage';

/** The layer of the parts that occlude. */
const OCCLUDERS = 2;
/** Largest number of pixels of the occlusion. */
const MOST_PIXELS = 4e6;
/** Largest radius of the surroundings on the screen, as a share of the height of a picture. */
const LARGEST_RADIUS = 0.22;

const VERTEX = /* glsl */ `
void main() { gl_Position = vec4( 2.0 * position.xy, 0.0, 1.0 ); }`;

/** Visibility by the horizons in each direction [Jimenez]. */
const HORIZONS = /* glsl */ `
#define DIRECTIONS 2
#define STEPS 4
#define HALF_PI 1.5707963
uniform sampler2D depths;
/** Place of the picture in the textures, and the size of the textures [px]. */
uniform vec4 place;
uniform vec2 size;
uniform mat4 projection;
uniform float radius, pixelsPerSlope, largest;
uniform bool orthographic;

// The inverse of the projection, whose other elements are zero.
vec3 positionAt( vec2 pixel ) {
  vec3 at = vec3( 2.0 * ( pixel - place.xy ) / place.zw - 1.0, 2.0 * texture2D( depths, pixel / size ).r - 1.0 );
  vec2 scale = vec2( projection[ 0 ][ 0 ], projection[ 1 ][ 1 ] );
  if ( orthographic ) return vec3( at.xy - projection[ 3 ].xy, at.z - projection[ 3 ].z ) / vec3( scale, projection[ 2 ].z );
  float depth = projection[ 3 ].z / ( at.z + projection[ 2 ].z );
  return vec3( depth * ( at.xy + projection[ 2 ].xy ) / scale, - depth );
}

// Within 0.001 of the arc cosine.
float arcCosine( float value ) {
  float size = min( abs( value ), 1.0 );
  float found = sqrt( 1.0 - size ) * ( ( ( - 0.0187293 * size + 0.0742610 ) * size - 0.2121144 ) * size + HALF_PI );
  return value < 0.0 ? 2.0 * HALF_PI - found : found;
}

/** The shorter one of the differences to the neighbours on both sides: the other one may be across an edge. */
vec3 tangent( vec3 here, vec2 by ) {
  vec3 after = positionAt( gl_FragCoord.xy + by ) - here;
  vec3 before = here - positionAt( gl_FragCoord.xy - by );
  return abs( after.z ) < abs( before.z ) ? after : before;
}

/**
 * The highest elevation of the surroundings in a direction. Sampled pixels are up to half a pixel off that direction: what they are off along
 * the normal of its plane, the axis, is removed parallel to the surface, so that a plane does not occlude itself.
 */
float horizon( vec3 here, vec3 eye, vec2 direction, vec3 axis, vec3 aside, float length_px, float lowest, float jitter ) {
  float highest = lowest;
  for ( int i = 0; i < STEPS; i ++ ) {
    float share = ( float( i ) + jitter ) / float( STEPS );
    vec2 pixel = gl_FragCoord.xy + direction * ( 1.5 + length_px * share * share );
    pixel = floor( pixel ) + 0.5;
    if ( any( lessThan( pixel, place.xy ) ) || any( greaterThan( pixel, place.xy + place.zw ) ) ) break;
    vec3 to = positionAt( pixel ) - here;
    to -= dot( to, axis ) * aside;
    float far = length( to );
    // Parts at the end of the radius have no effect, so that none begins suddenly.
    float weight = clamp( 2.0 - 2.0 * far / radius, 0.0, 1.0 );
    highest = max( highest, mix( lowest, dot( to, eye ) / far, weight ) );
  }
  return highest;
}

void main() {
  if ( texture2D( depths, gl_FragCoord.xy / size ).r >= 1.0 ) {
    gl_FragColor = vec4( 1.0, 0.0, 0.0, 1.0 );
    return;
  }
  vec3 here = positionAt( gl_FragCoord.xy );
  vec3 normal = normalize( cross( tangent( here, vec2( 1.0, 0.0 ) ), tangent( here, vec2( 0.0, 1.0 ) ) ) );
  vec3 eye = orthographic ? vec3( 0.0, 0.0, 1.0 ) : normalize( - here );
  float length_px = min( radius * pixelsPerSlope / ( orthographic ? 1.0 : - here.z ), largest );
  // Sixteen rotations in cells of 4 x 4 pixels, which the smoothing averages.
  ivec2 cell = ivec2( gl_FragCoord.xy ) & 3;
  float rotation = float( ( cell.x * 4 + cell.y * 9 + ( cell.x ^ cell.y ) * 2 ) & 15 ) / 16.0;
  float jitter = float( ( cell.x * 7 + cell.y * 4 ) & 15 ) / 16.0;
  float open = 0.0;
  for ( int i = 0; i < DIRECTIONS; i ++ ) {
    float angle = 2.0 * HALF_PI * ( float( i ) + rotation ) / float( DIRECTIONS );
    vec2 direction = vec2( cos( angle ), sin( angle ) );
    vec3 along = vec3( direction, 0.0 );
    vec3 axis = normalize( cross( along, eye ) );
    vec3 projected = normal - axis * dot( normal, axis );
    float share = length( projected );
    vec3 upright = along - eye * dot( along, eye );
    float tilt = sign( dot( upright, projected ) ) * arcCosine( dot( projected, eye ) / max( share, 1e-5 ) );
    vec3 aside = ( axis - normal * dot( normal, axis ) ) / max( share * share, 1e-3 );
    float after = arcCosine( horizon( here, eye, direction, axis, aside, length_px, - sin( tilt ), jitter ) );
    float before = - arcCosine( horizon( here, eye, - direction, axis, aside, length_px, sin( tilt ), jitter ) );
    after = tilt + min( after - tilt, HALF_PI );
    before = tilt + max( before - tilt, - HALF_PI );
    open += share * 0.25 * ( 2.0 * cos( tilt ) + 2.0 * ( before + after ) * sin( tilt ) - cos( 2.0 * before - tilt ) - cos( 2.0 * after - tilt ) );
  }
  gl_FragColor = vec4( clamp( open / float( DIRECTIONS ), 0.0, 1.0 ), - here.z, 0.0, 1.0 );
}`;

/**
 * Averages over the cells of rotations, among pixels near the tangent plane: depths change much from pixel to pixel on surfaces that are seen
 * at a small angle. Pixels of the background take over the values next to them.
 */
const SMOOTHING = /* glsl */ `
uniform sampler2D occlusion;
uniform vec4 place;
uniform vec2 size;
uniform float radius;

/** Change of the depth to the next pixel: the smaller one of both sides, since the other one may be across an edge. */
float slope( float depth, vec2 by ) {
  float after = texture2D( occlusion, ( gl_FragCoord.xy + by ) / size ).g - depth;
  float before = depth - texture2D( occlusion, ( gl_FragCoord.xy - by ) / size ).g;
  return abs( after ) < abs( before ) ? after : before;
}

void main() {
  vec2 here = texture2D( occlusion, gl_FragCoord.xy / size ).rg;
  float sum = 0.0;
  float weights = 0.0;
  if ( here.g == 0.0 ) {
    for ( int i = 0; i < 4; i ++ ) {
      vec2 found = texture2D( occlusion, ( gl_FragCoord.xy + vec2( i == 0 ? 1 : i == 1 ? - 1 : 0, i == 2 ? 1 : i == 3 ? - 1 : 0 ) ) / size ).rg;
      float weight = found.g == 0.0 ? 0.0 : 1.0;
      sum += weight * found.r;
      weights += weight;
    }
    gl_FragColor = vec4( weights > 0.0 ? sum / weights : 1.0, 0.0, 0.0, 1.0 );
    return;
  }
  vec2 slopes = vec2( slope( here.g, vec2( 1.0, 0.0 ) ), slope( here.g, vec2( 0.0, 1.0 ) ) );
  for ( int x = - 2; x < 2; x ++ )
    for ( int y = - 2; y < 2; y ++ ) {
      vec2 pixel = gl_FragCoord.xy + vec2( float( x ), float( y ) );
      vec2 found = texture2D( occlusion, clamp( pixel, place.xy + 0.5, place.xy + place.zw - 0.5 ) / size ).rg;
      float weight = found.g == 0.0 ? 0.0 : max( 0.0, 1.0 - 8.0 * abs( found.g - here.g - dot( slopes, vec2( float( x ), float( y ) ) ) ) / radius );
      sum += weight * found.r;
      weights += weight;
    }
  gl_FragColor = vec4( sum / weights, 0.0, 0.0, 1.0 );
}`;

/** A picture that occlusion is computed for: a stage, and its place on the canvas [px from the lower left]. */
export interface OccludedPicture {
  stage: Stage;
  place: Box;
}

interface Targets {
  depths: WebGLRenderTarget;
  rough: WebGLRenderTarget;
  smooth: WebGLRenderTarget;
}

export class Occlusion {
  /** Lengths up to which parts occlude [units of the scene]. */
  readonly #radius: number;
  readonly #depth = new MeshBasicMaterial({ colorWrite: false, side: DoubleSide });
  readonly #horizons = new ShaderMaterial({
    depthTest: false,
    depthWrite: false,
    vertexShader: VERTEX,
    fragmentShader: HORIZONS,
    uniforms: {
      depths: { value: null },
      place: { value: new Vector4() },
      size: { value: new Vector2() },
      projection: { value: new Matrix4() },
      radius: { value: 1 },
      pixelsPerSlope: { value: 1 },
      largest: { value: 1 },
      orthographic: { value: false },
    },
  });
  readonly #smoothing = new ShaderMaterial({
    depthTest: false,
    depthWrite: false,
    vertexShader: VERTEX,
    fragmentShader: SMOOTHING,
    uniforms: { occlusion: { value: null }, place: { value: new Vector4() }, size: { value: new Vector2() }, radius: { value: 1 } },
  });
  readonly #flat = new Mesh(new PlaneGeometry(1, 1), this.#horizons);
  readonly #pass = new Scene();
  #targets: Targets | null = null;
  /** What the occlusion was computed for. */
  #key = '';

  constructor(radius: number) {
    this.#radius = radius;
    this.#flat.frustumCulled = false;
    this.#pass.add(this.#flat);
  }

  dispose(): void {
    this.#clear();
    this.#depth.dispose();
    this.#horizons.dispose();
    this.#smoothing.dispose();
    this.#flat.geometry.dispose();
  }

  #clear(): void {
    if (!this.#targets) return;
    const { depths, rough, smooth } = this.#targets;
    depths.depthTexture?.dispose();
    for (const target of [depths, rough, smooth]) target.dispose();
    this.#targets = null;
    this.#key = '';
  }

  /** Textures of a size [px]. */
  #sized(width: number, height: number): Targets {
    if (this.#targets?.depths.width === width && this.#targets.depths.height === height) return this.#targets;
    this.#clear();
    const depths = new WebGLRenderTarget(width, height, { minFilter: NearestFilter, magFilter: NearestFilter });
    depths.depthTexture = new DepthTexture(width, height, UnsignedIntType);
    const rough = new WebGLRenderTarget(width, height, { format: RGFormat, type: HalfFloatType, minFilter: NearestFilter, magFilter: NearestFilter, depthBuffer: false });
    const smooth = new WebGLRenderTarget(width, height, { depthBuffer: false });
    this.#targets = { depths, rough, smooth };
    return this.#targets;
  }

  /**
   * Prepares the materials for pictures on one canvas: if requested, by a new occlusion unless the last one is of this picture;
   * otherwise by the last one if it is of this picture, or without.
   *
   * `detail` is the number of pixels of the canvas for one of the occlusion.
   */
  prepare(renderer: WebGLRenderer, pictures: readonly OccludedPicture[], camera: Camera, detail: number, requested: boolean): void {
    // Some old devices cannot render into textures of floating-point numbers.
    const computes = requested && ['EXT_color_buffer_float', 'EXT_color_buffer_half_float'].some((name) => renderer.extensions.has(name));
    camera.updateMatrixWorld();
    const canvas = renderer.getDrawingBufferSize(occlusionUniforms.occlusionSize.value);
    const shape = pictures.map(({ stage, place }) => `${stage.scene.id} ${stage.surfaces} ${[place.left, place.bottom, place.right, place.top].map((value, i) => (value / (i % 2 ? canvas.height : canvas.width)).toFixed(4)).join(' ')}`);
    const key = [...shape, ...camera.matrixWorld.elements, ...camera.projectionMatrix.elements].join(' ');
    const isValid = key === this.#key;
    if (!isValid && computes) this.#compute(renderer, pictures, camera, canvas, detail);
    if (computes) this.#key = key;
    occlusionUniforms.occlusionMap.value = this.#targets?.smooth.texture ?? null;
    occlusionUniforms.occlusionStrength.value = isValid || computes ? 1 : 0;
  }

  #compute(renderer: WebGLRenderer, pictures: readonly OccludedPicture[], camera: Camera, canvas: Vector2, detail: number): void {
    const share = Math.min(1 / detail, Math.sqrt(MOST_PIXELS / (canvas.width * canvas.height)));
    const { depths, rough, smooth } = this.#sized(Math.ceil(canvas.width * share), Math.ceil(canvas.height * share));
    const size = new Vector2(depths.width, depths.height);
    const scale = new Vector2(depths.width / canvas.width, depths.height / canvas.height);
    const { layers, projectionMatrix } = camera;
    const before = { mask: layers.mask, shadows: renderer.shadowMap.needsUpdate };
    // Shadows are rendered with the layers of the whole picture.
    renderer.shadowMap.needsUpdate = false;
    try {
      for (const { stage, place } of pictures) {
        const box = new Vector4(place.left * scale.x, place.bottom * scale.y, (place.right - place.left) * scale.x, (place.top - place.bottom) * scale.y).round();
        for (const target of [depths, rough, smooth]) {
          target.viewport.copy(box);
          target.scissor.copy(box);
          target.scissorTest = true;
        }
        markOccluders(stage.scene);
        layers.set(OCCLUDERS);
        stage.scene.overrideMaterial = this.#depth;
        renderer.setRenderTarget(depths);
        renderer.render(stage.scene, camera);
        stage.scene.overrideMaterial = null;
        layers.mask = before.mask;
        const isOrthographic = projectionMatrix.elements[15] === 1;
        assign(this.#horizons, { depths: depths.depthTexture, place: box, size, projection: projectionMatrix, radius: this.#radius, pixelsPerSlope: 0.5 * projectionMatrix.elements[5]! * box.w, largest: LARGEST_RADIUS * box.w, orthographic: isOrthographic });
        this.#run(renderer, this.#horizons, rough, camera);
        assign(this.#smoothing, { occlusion: rough.texture, place: box, size, radius: this.#radius });
        this.#run(renderer, this.#smoothing, smooth, camera);
      }
    } finally {
      layers.mask = before.mask;
      renderer.setRenderTarget(null);
      renderer.shadowMap.needsUpdate = before.shadows;
    }
  }

  #run(renderer: WebGLRenderer, material: ShaderMaterial, target: WebGLRenderTarget, camera: Camera): void {
    this.#flat.material = material;
    renderer.setRenderTarget(target);
    renderer.render(this.#pass, camera);
  }
}

function assign({ uniforms }: ShaderMaterial, values: Record<string, unknown>): void {
  for (const [name, value] of Object.entries(values)) uniforms[name]!.value = value;
}

/** Puts the opaque, physically based parts of a scene that are not hidden into the layer of occluders. */
function markOccluders(scene: Scene): void {
  scene.traverse((part) => {
    if (!(part instanceof Mesh)) return;
    const materials = (Array.isArray(part.material) ? part.material : [part.material]) as MeshStandardMaterial[];
    const isOpaque = materials.every((material) => material instanceof MeshStandardMaterial && !material.transparent);
    if (part.layers.isEnabled(0) && isOpaque) part.layers.enable(OCCLUDERS);
    else part.layers.disable(OCCLUDERS);
  });
}
