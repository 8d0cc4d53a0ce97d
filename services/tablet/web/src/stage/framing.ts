import { Vector3, type PerspectiveCamera } from 'three';
import type { Pose } from '../figure/pose';
import { Joint } from '../figure/skeleton';

/** Height of what the first view holds: a pupil with raised arms. Above an attempt there is so much air. */
const VIEW_HEIGHT_M = 2.4;
const AIR_M = 0.5;
const VIEW_WIDTH_M = 1.9;
/** Of two who stand beside one another. */
const PAIR_WIDTH_M = 3.3;
/** From the pupil to the standard beside him. */
export const BESIDE_M = 1.2;
const MIDDLE_M = 0.84;
/** The first view comes from the front, a little from the pupil's left and from above. */
const AZIMUTH_OFFSET_RAD = 0.62;
/** An attempt is seen more from the side, the one that leads: there knees, hips and trunk show what they do. */
const ATTEMPT_OFFSET_RAD = 0.95;
const ELEVATION_RAD = 0.2;
const LIGHT_AZIMUTH_RAD = 0.7;
const LIGHT_ELEVATION_RAD = 0.95;
const LIGHT_DISTANCE_M = 6;

/** The pupil may move so far from the view's middle before the view follows, and with this time constant. */
const FREE_M = 0.15;
const FOLLOW_S = 0.25;

/** What the view turns about: the middle of the hips, at the height of the middle of an upright pupil. */
export function standpoint(pose: Pose, into: Vector3): Vector3 {
  return hips(pose, into).setZ(MIDDLE_M);
}

/** The middle of the hips. */
export function hips(pose: Pose, into: Vector3): Vector3 {
  const p = pose.positionsM;
  const middle = (axis: number): number => (p[3 * Joint.LeftHip + axis]! + p[3 * Joint.RightHip + axis]!) / 2;
  return into.set(middle(0), middle(1), middle(2));
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

/** How far away a camera shows a whole pupil, whatever the shape of the screen. */
export function firstDistanceM(camera: PerspectiveCamera): number {
  return distanceM(camera, VIEW_HEIGHT_M, VIEW_WIDTH_M);
}

function distanceM(camera: PerspectiveCamera, heightM: number, widthM: number): number {
  const halfHeight = Math.tan((camera.fov * Math.PI) / 360);
  return Math.max(heightM / 2 / halfHeight, widthM / 2 / (halfHeight * camera.aspect));
}

/** The position of a camera that shows the whole pupil at `target`. */
export function firstView(pose: Pose, target: Vector3, camera: PerspectiveCamera): Vector3 {
  return around(facingRad(pose) + AZIMUTH_OFFSET_RAD, ELEVATION_RAD, firstDistanceM(camera)).add(target);
}

/** An attempt as the view has to hold it. */
export interface Framed {
  /** The direction that the pupil looks in at its beginning. */
  facing: number;
  handed: 'right' | 'left';
  /** How high it goes. */
  heightM: number;
}

/** How far away a camera shows an attempt, and the standard beside it where there is a pair. */
export function attemptDistanceM(camera: PerspectiveCamera, { heightM }: Framed, pair: boolean): number {
  return distanceM(camera, heightM + AIR_M, pair ? PAIR_WIDTH_M : VIEW_WIDTH_M);
}

/** The position of a camera that shows an attempt from the side that leads; `target` is raised to the middle of it. */
export function attemptView(framed: Framed, target: Vector3, camera: PerspectiveCamera, pair: boolean): Vector3 {
  const side = framed.handed === 'right' ? -1 : 1;
  target.setZ((framed.heightM + 0.3 * AIR_M) / 2);
  const away = attemptDistanceM(camera, framed, pair);
  return around(framed.facing + side * ATTEMPT_OFFSET_RAD, ELEVATION_RAD, away).add(target);
}

/** Where the light comes from, seen from the pupil: over the right shoulder of the one who looks from the first view. */
export function lightOffset(pose: Pose): Vector3 {
  return lightFrom(facingRad(pose) + AZIMUTH_OFFSET_RAD);
}

/** The same for an attempt: the light comes from where it is looked at, so that no colour lies in the dark. */
export function attemptLight({ facing, handed }: Framed): Vector3 {
  return lightFrom(facing + (handed === 'right' ? -ATTEMPT_OFFSET_RAD : ATTEMPT_OFFSET_RAD));
}

function lightFrom(viewRad: number): Vector3 {
  return around(viewRad + LIGHT_AZIMUTH_RAD, LIGHT_ELEVATION_RAD, LIGHT_DISTANCE_M);
}

function around(azimuth: number, elevation: number, distance: number): Vector3 {
  const level = Math.cos(elevation);
  return new Vector3(level * Math.cos(azimuth), level * Math.sin(azimuth), Math.sin(elevation)).multiplyScalar(
    distance,
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
