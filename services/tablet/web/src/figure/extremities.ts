import { Matrix4, Mesh, SphereGeometry, Vector3, type BufferGeometry } from 'three';
import { alongY, mesh } from './limb';
import { DRAWN } from './materials';

const ANKLE_HEIGHT_M = 0.075;
const FOOT_LENGTH_M = 0.25;
const HEEL_SHARE = 0.28;

/** A hand: drawn along the forearm, not measured. */
export class Hand {
  readonly mesh: Mesh = mesh(new SphereGeometry(1, 20, 14), DRAWN);

  constructor(
    readonly elbow: number,
    readonly wrist: number,
  ) {}

  place(elbow: Vector3, wrist: Vector3, scale: number): void {
    const along = wrist.clone().sub(elbow).normalize();
    const middle = wrist.clone().addScaledVector(along, 0.062 * scale);
    this.mesh.matrix.copy(alongY(middle, middle.clone().add(along)));
    this.mesh.matrix.scale(new Vector3(0.036 * scale, 0.082 * scale, 0.03 * scale));
  }
}

/** A foot: square to the shank and towards where the body looks, never through the floor; drawn, not measured. */
export class Foot {
  readonly mesh: Mesh = mesh(soleGeometry(), DRAWN);

  constructor(
    readonly knee: number,
    readonly ankle: number,
  ) {}

  place(knee: Vector3, ankle: Vector3, bodyForward: Vector3, scale: number): void {
    const down = ankle.clone().sub(knee).normalize();
    const forward = bodyForward.clone().addScaledVector(down, -bodyForward.dot(down));
    if (forward.lengthSq() < 1e-4) forward.set(-down.z, 0, down.x);
    forward.normalize();
    keepAboveFloor(forward, ankle, scale);
    const left = new Vector3().crossVectors(down.clone().negate(), forward).normalize();
    const up = new Vector3().crossVectors(forward, left).normalize();
    const length = FOOT_LENGTH_M * scale;
    const middle = ankle
      .clone()
      .addScaledVector(forward, (0.5 - HEEL_SHARE) * length)
      .addScaledVector(up, -0.5 * ANKLE_HEIGHT_M * scale);
    this.mesh.matrix.copy(new Matrix4().makeBasis(forward, left, up).setPosition(middle));
    this.mesh.matrix.scale(new Vector3(0.5 * length, 0.046 * scale, 0.5 * ANKLE_HEIGHT_M * scale));
  }
}

/** Tilts a foot's direction (unit length, changed in place) up until neither toe nor heel is below the floor. */
function keepAboveFloor(forward: Vector3, ankle: Vector3, scale: number): void {
  const room = Math.max(ankle.z - ANKLE_HEIGHT_M * scale, 0);
  const toeReach = (1 - HEEL_SHARE) * FOOT_LENGTH_M * scale;
  const lowest = -Math.min(room / toeReach, 1);
  const highest = Math.min((room + 0.02) / (HEEL_SHARE * FOOT_LENGTH_M * scale), 1);
  const z = Math.min(Math.max(forward.z, lowest), highest);
  const level = Math.hypot(forward.x, forward.y);
  if (level < 1e-6) return;
  const factor = Math.sqrt(1 - z * z) / level;
  forward.set(forward.x * factor, forward.y * factor, z);
}

/** A shoe in the unit cube: round at the toe, higher at the heel (-x), flat below. */
function soleGeometry(): BufferGeometry {
  const geometry = new SphereGeometry(1, 28, 18);
  const position = geometry.getAttribute('position');
  for (let i = 0; i < position.count; i++) {
    const [x, y, z] = [position.getX(i), position.getY(i), position.getZ(i)];
    const box = (v: number): number => Math.sign(v) * Math.abs(v) ** 0.72;
    const height = z > 0 ? 1 - 0.42 * (0.5 + 0.5 * x) : 1;
    const waist = 1 - 0.12 * (1 - x);
    position.setXYZ(i, box(x), box(y) * waist, Math.max(box(z), -0.92) * height);
  }
  geometry.computeVertexNormals();
  return geometry;
}
