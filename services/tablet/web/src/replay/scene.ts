/** What the figure and the standard look like at a moment of an attempt. */

import { complete, showsSomebody, standing, type Pose } from '../figure/pose';
import { JOINT_COUNT } from '../protocol/motionFrame';
import { Level, type AttemptReplay } from '../protocol/attemptReplay';

/** Where the standard is drawn. */
export type StandardShown = 'ghost' | 'beside' | 'off';

export interface Moment {
  pose: Pose;
  /** 17 levels, one a joint. */
  levels: Uint8Array;
  /** The standard at the same point of the movement; null where there is none. */
  standard: Pose | null;
}

const AXES = 3 * JOINT_COUNT;
/** Each joint's counterpart on the other side of the body. */
const OTHER_SIDE = [0, 2, 1, 4, 3, 6, 5, 8, 7, 10, 9, 12, 11, 14, 13, 16, 15];

/**
 * The attempt with a place for every joint, so that both figures stay whole; states and levels say as before what is not known. Where
 * nothing of the standard's trunk is known there is no standard.
 */
export function whole(replay: AttemptReplay): AttemptReplay {
  const positionsM = new Float32Array(replay.positionsM.length);
  const standardM = new Float32Array(replay.standardM.length).fill(NaN);
  let pose = standing();
  let standard = standing();
  for (let frame = 0; frame < replay.frames; frame++) {
    pose = complete(poseOf(replay.positionsM, replay.states, frame), pose);
    positionsM.set(pose.positionsM, frame * AXES);
    const model = poseOf(replay.standardM, replay.standardStates, frame);
    if (!showsSomebody(model)) continue;
    standard = complete(model, standard);
    standardM.set(standard.positionsM, frame * AXES);
  }
  return { ...replay, positionsM, standardM };
}

/** Whether there is a standard to be shown in any frame. */
export function hasStandard(replay: AttemptReplay): boolean {
  return replay.standardM.some(Number.isFinite);
}

function poseOf(positionsM: Float32Array, states: Uint8Array, frame: number): Pose {
  return {
    positionsM: positionsM.slice(frame * AXES, (frame + 1) * AXES),
    states: jointsOf(states, frame),
  };
}

function jointsOf(values: Uint8Array, frame: number): Uint8Array {
  return values.slice(frame * JOINT_COUNT, (frame + 1) * JOINT_COUNT);
}

/** The moment of an attempt that is `whole`, with places between two frames; states and levels are those of the nearer frame. */
export function momentAt(replay: AttemptReplay, positionS: number): Moment {
  const place = Math.min(Math.max(positionS / replay.frameS, 0), replay.frames - 1);
  const [first, nearest] = [Math.floor(place), Math.round(place)];
  const share = place - first;
  const standardM = between(replay.standardM, first, share);
  return {
    pose: { positionsM: between(replay.positionsM, first, share), states: jointsOf(replay.states, nearest) },
    levels: jointsOf(replay.levels, nearest),
    standard: standardM.every(Number.isFinite)
      ? { positionsM: standardM, states: jointsOf(replay.standardStates, nearest) }
      : null,
  };
}

function between(valuesM: Float32Array, frame: number, share: number): Float32Array {
  const start = valuesM.slice(frame * AXES, (frame + 1) * AXES);
  if (share === 0) return start;
  const next = (frame + 1) * AXES;
  return start.map((value, i) => value + share * (valuesM[next + i]! - value));
}

/** Frame by frame how far from the standard the joints are that are judged: 0 if all are green or nobody knows, 1 if all are red. */
export function amiss(replay: AttemptReplay): number[] {
  return Array.from({ length: replay.frames }, (_, frame) => {
    const known = jointsOf(replay.levels, frame).filter((level) => level !== Level.Grey);
    const sum = known.reduce((total, level) => total + (level - Level.Green) / (Level.Red - Level.Green), 0);
    // One joint of many is to be seen, too.
    return known.length > 0 ? Math.sqrt(sum / known.length) : 0;
  });
}

/** How high the attempt goes, pupil and standard. */
export function heightM(replay: AttemptReplay): number {
  const highest = (placesM: Float32Array): number =>
    placesM.reduce((most, value, i) => (i % 3 === 2 && value > most ? value : most), 0);
  return Math.max(highest(replay.positionsM), highest(replay.standardM));
}

/** A vertical mirror: a point on it and the direction that is turned over. */
export interface Mirror {
  at: readonly [x: number, y: number];
  /** Unit length. */
  across: readonly [x: number, y: number];
}

/** The moment as it is seen in a mirror: what was left is right, on the body too. */
export function mirrored(moment: Moment, mirror: Mirror): Moment {
  return {
    pose: mirroredPose(moment.pose, mirror),
    levels: exchanged(moment.levels),
    standard: moment.standard && mirroredPose(moment.standard, mirror),
  };
}

function mirroredPose(pose: Pose, { at, across }: Mirror): Pose {
  const positionsM = new Float32Array(AXES);
  OTHER_SIDE.forEach((from, joint) => {
    const [x, y, z] = pose.positionsM.subarray(3 * from, 3 * from + 3) as unknown as [number, number, number];
    const distance = (x - at[0]) * across[0] + (y - at[1]) * across[1];
    positionsM.set([x - 2 * distance * across[0], y - 2 * distance * across[1], z], 3 * joint);
  });
  return { positionsM, states: exchanged(pose.states) };
}

function exchanged(values: Uint8Array): Uint8Array {
  return Uint8Array.from(OTHER_SIDE, (joint) => values[joint]!);
}

/** The same pose somewhere else. */
export function moved(pose: Pose, byM: readonly [x: number, y: number]): Pose {
  return {
    positionsM: pose.positionsM.map((value, i) => (i % 3 === 2 ? value : value + byM[i % 3]!)),
    states: pose.states,
  };
}
