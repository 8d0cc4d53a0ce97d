import { Vector3, type PerspectiveCamera } from 'three';
import type { Pose } from '../figure/pose';
import { Joint } from '../figure/skeleton';

/** Height of what the first view holds: a pupil with raised arms. */
const VIEW_HEIGHT_M = 2.3;
const VIEW_WIDTH_M = 1.9;
const MIDDLE_M = 0.92;
/** The first view comes from the front, a little from the pupil's left and from above. */
const AZIMUTH_OFFSET_RAD = 0.62;
const ELEVATION_RAD = 0.2;

/** Where the pupil is on the floor: the middle of the hips. */
export function standpoint(pose: Pose, into: Vector3): Vector3 {
  const p = pose.positionsM;
  const [l, r] = [3 * Joint.LeftHip, 3 * Joint.RightHip];
  return into.set((p[l]! + p[r]!) / 2, (p[l + 1]! + p[r + 1]!) / 2, MIDDLE_M);
}

/** The direction that the pupil looks in, as an angle about the vertical; from the hips and shoulders. */
export function facingRad(pose: Pose): number {
  const p = pose.positionsM;
  const across = (axis: number): number =>
    p[3 * Joint.LeftHip + axis]! -
    p[3 * Joint.RightHip + axis]! +
    p[3 * Joint.LeftShoulder + axis]! -
    p[3 * Joint.RightShoulder + axis]!;
  return Math.atan2(-across(0), across(1));
}

/** The position of a camera that shows the whole pupil at `target`, whatever the shape of the screen. */
export function firstView(pose: Pose, target: Vector3, camera: PerspectiveCamera): Vector3 {
  const halfHeight = Math.tan((camera.fov * Math.PI) / 360);
  const distance = Math.max(VIEW_HEIGHT_M / 2 / halfHeight, VIEW_WIDTH_M / 2 / (halfHeight * camera.aspect));
  const azimuth = facingRad(pose) + AZIMUTH_OFFSET_RAD;
  return new Vector3(
    target.x + distance * Math.cos(ELEVATION_RAD) * Math.cos(azimuth),
    target.y + distance * Math.cos(ELEVATION_RAD) * Math.sin(azimuth),
    target.z + distance * Math.sin(ELEVATION_RAD),
  );
}

/** How far the view moves after a pupil who leaves its middle: nothing near it, then as much as is needed, gently. */
export function follow(target: Vector3, standpoint: Vector3, seconds: number, into: Vector3): Vector3 {
  into.subVectors(standpoint, target).setZ(0);
  const distance = into.length();
  if (distance < FREE_M) return into.set(0, 0, 0);
  const share = ((distance - FREE_M) / distance) * (1 - Math.exp(-seconds / FOLLOW_S));
  return into.multiplyScalar(share);
}

const FREE_M = 0.25;
const FOLLOW_S = 0.35;
