import { JOINT_COUNT, JointState } from '../protocol/motionFrame';
import { PARENT, STANDING_M, TRUNK } from './skeleton';

/** A place for every joint and how far it may be believed. */
export interface Pose {
  positionsM: Float32Array;
  states: Uint8Array;
}

/** The figure that stands for "no data": every joint unknown. */
export function standing(): Pose {
  return { positionsM: STANDING_M.slice(), states: new Uint8Array(JOINT_COUNT) };
}

/** The same figure with nothing believed any more, for when it has become old. */
export function unsure(pose: Pose): Pose {
  return { positionsM: pose.positionsM, states: pose.states.map((state) => Math.min(state, JointState.Guessed)) };
}

/** Whether a frame shows anybody: without one joint of the trunk there is nothing to hang a figure on. */
export function showsSomebody(frame: Pose): boolean {
  return TRUNK.some((joint) => frame.states[joint] !== JointState.Unknown);
}

/**
 * Gives unknown joints a place, so that the figure stays whole: the one they had before relative to the joint that they hang on. They stay
 * unknown, and are drawn as such.
 */
export function complete(frame: Pose, before: Pose): Pose {
  const positionsM = frame.positionsM.slice();
  const shift = trunkShift(frame, before);
  for (const joint of TRUNK) {
    if (frame.states[joint] === JointState.Unknown) place(positionsM, joint, before.positionsM, shift);
  }
  for (let joint = 0; joint < JOINT_COUNT; joint++) {
    const parent = PARENT[joint]!;
    if (parent < 0 || frame.states[joint] !== JointState.Unknown) continue;
    place(positionsM, joint, before.positionsM, difference(positionsM, before.positionsM, parent));
  }
  return { positionsM, states: frame.states.slice() };
}

type Triple = [number, number, number];

/** How far the known joints of the trunk moved on average since the pose before. */
function trunkShift(frame: Pose, before: Pose): Triple {
  const known = TRUNK.filter((joint) => frame.states[joint] !== JointState.Unknown);
  const sum: Triple = [0, 0, 0];
  for (const joint of known) {
    const moved = difference(frame.positionsM, before.positionsM, joint);
    for (let axis = 0; axis < 3; axis++) sum[axis]! += moved[axis]! / known.length;
  }
  return sum;
}

function difference(now: Float32Array, then: Float32Array, joint: number): Triple {
  const at = 3 * joint;
  return [now[at]! - then[at]!, now[at + 1]! - then[at + 1]!, now[at + 2]! - then[at + 2]!];
}

function place(positions: Float32Array, joint: number, from: Float32Array, shift: Triple): void {
  for (let axis = 0; axis < 3; axis++) positions[3 * joint + axis] = from[3 * joint + axis]! + shift[axis]!;
}
