import { LatheGeometry, Matrix4, Mesh, SphereGeometry, Vector2, Vector3, type BufferGeometry } from 'three';
import { SHARES, share } from './judged';
import type { Palette } from './materials';

/** Radii of a body of 1.70 m along a segment, from its near end (0) to its far end (1), in metres. */
type Profile = readonly (readonly [along: number, radiusM: number])[];

export const UPPER_ARM: Profile = [
  [0, 0.051],
  [0.2, 0.049],
  [0.55, 0.044],
  [1, 0.036],
];
export const FOREARM: Profile = [
  [0, 0.036],
  [0.25, 0.04],
  [0.6, 0.033],
  [1, 0.024],
];
export const THIGH: Profile = [
  [0, 0.077],
  [0.25, 0.079],
  [0.65, 0.064],
  [1, 0.05],
];
export const SHANK: Profile = [
  [0, 0.05],
  [0.28, 0.055],
  [0.65, 0.042],
  [1, 0.033],
];

const AROUND = 20;
const ALONG = 10;

/** One segment between two joints: a turned body that is stretched along y and scaled with the person across, and a round far joint. */
export class Limb {
  readonly shaft: Mesh;
  readonly knob: Mesh;

  constructor(
    readonly from: number,
    readonly to: number,
    private readonly profile: Profile,
    readonly palette: Palette,
  ) {
    this.shaft = mesh(turned(profile), palette);
    this.knob = mesh(new SphereGeometry(1, AROUND, 12), palette);
  }

  place(a: Vector3, b: Vector3, scale: number): void {
    const length = a.distanceTo(b);
    this.shaft.matrix.copy(alongY(a, b)).scale(SCALE.set(scale, Math.max(length, 1e-4), scale));
    const radius = this.profile.at(-1)![1] * scale;
    this.knob.matrix.makeScale(radius, radius, radius).setPosition(b);
  }
}

const SCALE = new Vector3();
const X = new Vector3();
const Y = new Vector3();
const Z = new Vector3();
const MATRIX = new Matrix4();

/** Frame at `a` whose y axis points to `b`; the result is overwritten by the next call. */
export function alongY(a: Vector3, b: Vector3): Matrix4 {
  Y.subVectors(b, a);
  if (Y.lengthSq() < 1e-12) Y.set(0, 0, -1);
  Y.normalize();
  X.set(1, 0, 0);
  if (Math.abs(Y.x) > 0.9) X.set(0, 1, 0);
  Z.crossVectors(X, Y).normalize();
  X.crossVectors(Y, Z);
  return MATRIX.makeBasis(X, Y, Z).setPosition(a);
}

/** A mesh whose matrix is set by hand, that throws and receives shadow. It belongs to one joint unless its geometry says otherwise. */
export function mesh(geometry: BufferGeometry, palette: Palette): Mesh {
  if (!geometry.hasAttribute(SHARES)) share(geometry, () => [1, 0, 0, 0]);
  const made = new Mesh(geometry, palette.unknown);
  made.matrixAutoUpdate = false;
  made.castShadow = true;
  made.receiveShadow = true;
  // Bounds are not kept up to date for parts that deform; the figure is always in view anyway.
  made.frustumCulled = false;
  return made;
}

function turned(profile: Profile): BufferGeometry {
  const points: Vector2[] = [];
  for (let step = 0; step <= ALONG; step++) {
    const along = step / ALONG;
    points.push(new Vector2(interpolate(profile, along), along));
  }
  const geometry = new LatheGeometry(points, AROUND);
  const position = geometry.getAttribute('position');
  share(geometry, (vertex) => [1 - position.getY(vertex), position.getY(vertex), 0, 0]);
  return geometry;
}

/** Smooth interpolation of a profile (monotone between its points). */
export function interpolate(profile: Profile, along: number): number {
  for (let i = 1; i < profile.length; i++) {
    const [x0, y0] = profile[i - 1]!;
    const [x1, y1] = profile[i]!;
    if (along <= x1) {
      const t = (along - x0) / (x1 - x0);
      return y0 + (y1 - y0) * t * t * (3 - 2 * t);
    }
  }
  return profile.at(-1)![1];
}
