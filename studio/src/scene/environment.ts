// Light of all scenes: an environment that is computed in the shader, and soft shadows of the key light.
//
// The environment is a sky with two soft boxes. An image of it would have to be filtered for each roughness, which takes seconds
// without a graphics card; the functions below are filtered by construction. They apply to every physically based material.

import { AmbientLight, MeshStandardMaterial, ShaderChunk, Vector2, type Texture } from 'three';

/** Directions to the soft boxes, in the base frame with z up: the key light of each scene is near the first one. */
const FUNCTIONS = /* glsl */ `
const vec3 KEY_BOX = vec3( 0.310, -0.424, 0.851 );
const vec3 RIM_BOX = vec3( -0.530, 0.740, 0.414 );
const vec3 SIDE_BOX = vec3( 0.858, - 0.429, - 0.283 );

float softBox( vec3 direction, vec3 box, float size, float blur ) {
  return smoothstep( size - blur, size + 0.35 * blur, dot( direction, box ) );
}

// Radiance from a direction, averaged over a lobe that grows with the roughness.
vec3 environmentRadiance( vec3 direction, float roughness ) {
  float blur = 0.05 + 0.75 * roughness;
  // A bright and a dark side give upright parts their shape.
  float side = dot( direction.xy, vec2( 0.59, - 0.807 ) );
  vec3 sky = mix( vec3( 0.86, 0.89, 0.93 ), vec3( 0.62, 0.68, 0.76 ), smoothstep( 0.05, 1.0, direction.z ) );
  vec3 all = mix( vec3( 0.52, 0.53, 0.55 ), sky, smoothstep( - 0.1 - blur, blur, direction.z ) );
  all *= 1.0 + 0.32 * side;
  float strength = 2.4 / ( 1.0 + 2.5 * roughness );
  all += strength * ( softBox( direction, KEY_BOX, 0.86, blur ) + 0.7 * softBox( direction, RIM_BOX, 0.9, blur ) );
  return all + 0.5 * strength * softBox( direction, SIDE_BOX, 0.93, blur );
}

// Mean radiance over the hemisphere about a normal, weighted by the cosine.
vec3 environmentIrradiance( vec3 normal ) {
  vec3 all = mix( vec3( 0.40, 0.42, 0.45 ), vec3( 0.80, 0.83, 0.88 ), 0.5 + 0.5 * normal.z );
  float key = max( 0.5 + 0.5 * dot( normal, KEY_BOX ), 0.0 );
  float rim = max( 0.5 + 0.5 * dot( normal, RIM_BOX ), 0.0 );
  return all + 0.30 * key * key + 0.14 * rim * rim;
}
`;

/** Uniforms of all physically based materials: the share of the environment that reaches each pixel, see `occlusion.ts`. */
export const occlusionUniforms = {
  occlusionMap: { value: null as Texture | null },
  /** Pixels of the picture along its edges. */
  occlusionSize: { value: new Vector2(1, 1) },
  /** 1, or 0 without occlusion. */
  occlusionStrength: { value: 0 },
};

const OCCLUSION = /* glsl */ `
uniform sampler2D occlusionMap;
uniform vec2 occlusionSize;
uniform float occlusionStrength;
float environmentShare() {
  #ifdef OPAQUE
    if ( occlusionStrength > 0.0 ) return mix( 1.0, texture2D( occlusionMap, gl_FragCoord.xy / occlusionSize ).r, occlusionStrength );
  #endif
  return 1.0;
}
`;

const APPLICATION = /* glsl */ `
#if defined( RE_IndirectSpecular )
  float share = environmentShare();
  iblIrradiance += share * PI * ambientLightColor * environmentIrradiance( inverseTransformDirection( geometryNormal, viewMatrix ) );
  radiance += share * ambientLightColor * environmentRadiance( inverseTransformDirection( reflect( - geometryViewDir, geometryNormal ), viewMatrix ), material.roughness );
  irradiance = vec3( 0.0 );
#endif
`;

/** Fixed sample points of shadows: those of three.js are rotated by noise, which is grainy and slow without a graphics card. */
const SAMPLES = /* glsl */ `
const vec2 SHADOW_DISK[ 5 ] = vec2[ 5 ]( vec2( 0.0 ), vec2( 0.894, 0.447 ), vec2( - 0.447, 0.894 ), vec2( - 0.894, - 0.447 ), vec2( 0.447, - 0.894 ) );
vec2 vogelDiskSample( int sampleIndex, int samplesCount, float phi ) { return SHADOW_DISK[ sampleIndex ]; }
`;

let installed = false;

/** Replaces a part of a shader of three.js; an unknown shader is an error. */
export function replacedPart(shader: string, part: RegExp, replacement: string): string {
  if (!part.test(shader)) throw new Error(`a shader of three.js no longer contains ${part}`);
  return shader.replace(part, replacement);
}

/** Installs the environment; the first scene calls it before its first frame. */
export function installEnvironment(): void {
  if (installed) return;
  installed = true;
  ShaderChunk.lights_physical_pars_fragment += FUNCTIONS + OCCLUSION;
  MeshStandardMaterial.prototype.onBeforeCompile = ({ uniforms }) => void Object.assign(uniforms, occlusionUniforms);
  ShaderChunk.lights_fragment_maps += APPLICATION;
  let shadows = replacedPart(ShaderChunk.shadowmap_pars_fragment, /vec2 vogelDiskSample\([^{]*\{[^}]*\}/, SAMPLES);
  shadows = replacedPart(shadows, /float phi = interleavedGradientNoise[^;]*;/, 'const float phi = 0.0;');
  ShaderChunk.shadowmap_pars_fragment = shadows;
}

/** The light whose intensity is that of the environment. */
export function environmentLight(): AmbientLight {
  return new AmbientLight(0xffffff);
}
