import { Matrix4, Mesh, RingGeometry, SphereGeometry, Vector3, type BufferGeometry } from 'three';
import { JointState } from '../protocol/motionFrame';
import { alongY, mesh } from './limb';
import { SKIN, VISOR } from './materials';
import type { Pose } from './pose';
import { Joint } from './skeleton';

const HALF_WIDTH_M = 0.076;
const HALF_DEPTH_M = 0.096;
const HALF_HEIGHT_M = 0.12;
/** The ears stand a little behind and below the middle of the head. */
const EARS_TO_CENTRE_M = { forward: 0.012, up: 0.02 };
const SHOULDERS_TO_EARS_M = 0.2;

/** Neck, head and a visor that shows which way the face looks. */
export class Head {
  readonly skull: Mesh = mesh(skullGeometry(), SKIN);
  readonly visor: Mesh = mesh(visorGeometry(), VISOR);
  readonly neck: Mesh = mesh(new SphereGeometry(1, 24, 16), SKIN);

  private readonly centre = new Vector3();
  private readonly left = new Vector3();
  private readonly up = new Vector3();
  private readonly forward = new Vector3();

  /**
   * @param neck middle of the shoulders
   * @param up direction of the trunk, unit length
   * @param trunkLeft from the right shoulder to the left, unit length
   */
  place(pose: Pose, neck: Vector3, up: Vector3, trunkLeft: Vector3, scale: number): void {
    const ears = this.ears(pose, neck, up, scale);
    this.orient(pose, ears, neck, up, trunkLeft);
    this.centre
      .copy(ears)
      .addScaledVector(this.forward, EARS_TO_CENTRE_M.forward * scale)
      .addScaledVector(this.up, EARS_TO_CENTRE_M.up * scale);
    const basis = new Matrix4().makeBasis(this.left, this.up, this.forward).setPosition(this.centre);
    const size = new Vector3(HALF_WIDTH_M, HALF_HEIGHT_M, HALF_DEPTH_M).multiplyScalar(scale);
    this.skull.matrix.copy(basis).scale(size);
    this.visor.matrix.copy(basis).scale(size);
    this.placeNeck(neck, scale);
  }

  private placeNeck(neck: Vector3, scale: number): void {
    const top = this.centre
      .clone()
      .addScaledVector(this.up, -0.06 * scale)
      .addScaledVector(this.forward, -0.02 * scale);
    const middle = neck.clone().lerp(top, 0.5);
    const half = Math.max(0.5 * neck.distanceTo(top), 1e-3);
    this.neck.matrix.copy(alongY(middle, top)).scale(new Vector3(0.054 * scale, half * 1.7, 0.054 * scale));
  }

  /** Middle of the ears: seen, or where the trunk and the rest of the face put it. */
  private ears(pose: Pose, neck: Vector3, up: Vector3, scale: number): Vector3 {
    const known = (joint: number): boolean => pose.states[joint] !== JointState.Unknown;
    if (known(Joint.LeftEar) && known(Joint.RightEar)) {
      return at(pose, Joint.LeftEar).add(at(pose, Joint.RightEar)).multiplyScalar(0.5);
    }
    const expected = neck.clone().addScaledVector(up, SHOULDERS_TO_EARS_M * scale);
    if (!known(Joint.Nose)) return expected;
    // Along the line from where the ears should be to the nose, at the distance that ears have from a nose.
    const nose = at(pose, Joint.Nose);
    const towards = nose.clone().sub(expected).normalize();
    return nose.addScaledVector(towards, -HALF_DEPTH_M * scale);
  }

  private orient(pose: Pose, ears: Vector3, neck: Vector3, up: Vector3, trunkLeft: Vector3): void {
    const known = (joint: number): boolean => pose.states[joint] !== JointState.Unknown;
    const bothEars = known(Joint.LeftEar) && known(Joint.RightEar);
    this.left.copy(bothEars ? at(pose, Joint.LeftEar).sub(at(pose, Joint.RightEar)) : trunkLeft);
    this.left.normalize();
    this.forward.crossVectors(trunkLeft, up);
    if (known(Joint.Nose)) this.forward.copy(at(pose, Joint.Nose).sub(ears));
    this.forward.addScaledVector(this.left, -this.forward.dot(this.left));
    if (this.forward.lengthSq() < 1e-8) this.forward.crossVectors(this.left, ears.clone().sub(neck));
    this.forward.normalize();
    this.up.crossVectors(this.forward, this.left).normalize();
  }
}

function at(pose: Pose, joint: number): Vector3 {
  return new Vector3().fromArray(pose.positionsM, 3 * joint);
}

/** An egg in the unit cube: narrower towards the chin (-y). */
function skullGeometry(): BufferGeometry {
  const geometry = new SphereGeometry(1, 28, 20);
  const position = geometry.getAttribute('position');
  for (let i = 0; i < position.count; i++) {
    const point = egg(new Vector3().fromBufferAttribute(position, i));
    position.setXYZ(i, point.x, point.y, point.z);
  }
  geometry.computeVertexNormals();
  return geometry;
}

function egg(point: Vector3): Vector3 {
  const below = Math.max(-point.y, 0);
  point.x *= 1 - 0.24 * below * below;
  point.z *= 1 - 0.12 * below * below;
  return point;
}

/** A rounded visor over the eyes, just above the skull's surface; the skull's +z looks forward. */
function visorGeometry(): BufferGeometry {
  const geometry = new RingGeometry(0, 1, 40, 6);
  const position = geometry.getAttribute('position');
  for (let i = 0; i < position.count; i++) {
    const [x, y] = [position.getX(i), position.getY(i)];
    // From a disc towards a rectangle with round corners, ring by ring.
    const stretch = Math.hypot(x, y) / Math.max((x ** 4 + y ** 4) ** 0.25, 1e-6);
    const [azimuth, elevation] = [0.92 * stretch * x, 0.1 + 0.25 * stretch * y];
    const [c, s] = [Math.cos(elevation), Math.sin(elevation)];
    const point = egg(new Vector3(Math.sin(azimuth) * c, s, Math.cos(azimuth) * c)).multiplyScalar(1.035);
    position.setXYZ(i, point.x, point.y, point.z);
  }
  geometry.computeVertexNormals();
  return geometry;
}
