import { BufferAttribute, Color, MeshLambertMaterial, Vector2, Vector4, type BufferGeometry } from 'three';

/**
 * Part of the figure coloured by how far its joints are from where they should be. Each point takes the level of the joint that is
 * nearest on the body. Yellow has dots and red has stripes, of an even size on the screen, so that nobody needs to tell colours.
 */
export interface Judged {
  material: MeshLambertMaterial;
  /** Levels of up to four joints, in the order of the geometry's shares. */
  levels: Vector4;
}

/** Pixels of the canvas, for the pattern's origin; the stage keeps it. */
export const CANVAS_PX = { value: new Vector2(1, 1) };

export const SHARES = 'shares';
const TONES = {
  grey: { value: new Color(0xa9adb3) },
  green: { value: new Color(0x2f9e5f) },
  yellow: { value: new Color(0xf5c026) },
  spot: { value: new Color(0x6b4a00) },
  red: { value: new Color(0xd32f26) },
  stripe: { value: new Color(0xffd9d4) },
};

const VERTEX = /* glsl */ `
  attribute vec4 ${SHARES};
  varying vec4 vShares;
  varying vec3 vOrigin;
`;
const VERTEX_BODY = /* glsl */ `
  vShares = ${SHARES};
  vOrigin = (projectionMatrix * modelViewMatrix * vec4(0.0, 0.0, 0.0, 1.0)).xyw;
`;
const FRAGMENT = /* glsl */ `
  varying vec4 vShares;
  varying vec3 vOrigin;
  uniform vec4 levels;
  uniform vec2 canvasPx;
  uniform vec3 grey;
  uniform vec3 green;
  uniform vec3 yellow;
  uniform vec3 spot;
  uniform vec3 red;
  uniform vec3 stripe;

  vec3 judged() {
    float most = max(max(vShares.x, vShares.y), max(vShares.z, vShares.w));
    float level = most == vShares.x ? levels.x : most == vShares.y ? levels.y : most == vShares.z ? levels.z : levels.w;
    vec2 px = gl_FragCoord.xy - 0.5 * canvasPx * (vOrigin.xy / vOrigin.z + 1.0);
    if (level > 2.5) return fract((px.x + px.y) / 13.0) < 0.62 ? red : stripe;
    if (level > 1.5) return length(fract(px / 9.0) - 0.5) < 0.27 ? spot : yellow;
    return level > 0.5 ? green : grey;
  }
`;

/** A material of one part; all share one program. */
export function judged(): Judged {
  const material = new MeshLambertMaterial();
  const levels = new Vector4();
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, { levels: { value: levels }, canvasPx: CANVAS_PX, ...TONES });
    shader.vertexShader = VERTEX + shader.vertexShader.replace('#include <begin_vertex>', `$&\n${VERTEX_BODY}`);
    shader.fragmentShader =
      FRAGMENT + shader.fragmentShader.replace('#include <color_fragment>', '$&\ndiffuseColor.rgb = judged();');
  };
  material.customProgramCacheKey = () => 'judged';
  return { material, levels };
}

type Shares = readonly [number, number, number, number];

/** Says for each point of a geometry how much it belongs to each of up to four joints. */
export function share(geometry: BufferGeometry, shares: (vertex: number) => Shares): void {
  const count = geometry.getAttribute('position').count;
  const values = new Float32Array(4 * count);
  for (let vertex = 0; vertex < count; vertex++) values.set(shares(vertex), 4 * vertex);
  geometry.setAttribute(SHARES, new BufferAttribute(values, 4));
}
