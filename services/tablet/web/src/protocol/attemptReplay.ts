/**
 * Reads the binary replay of an attempt; the layout is described in `services/tablet/attempt_replay.py` and held to the vectors in
 * `tests/golden/attempt_replay`.
 */

import { JOINT_COUNT, JointState } from './motionFrame';

/** How far a joint is from where it should be. Grey is: nobody knows. */
export const Level = { Grey: 0, Green: 1, Yellow: 2, Red: 3 } as const;
export const KEYFRAMES = 4;

const MAGIC = 0x5052424b; // "KBRP", read as a little-endian number
const VERSION = 1;
const HEADER_BYTES = 22;
const JOINT_BYTES = 8;
const STANDARD_BYTES = 6;
/** In the place of coordinates: there is no standard for this joint in this frame. */
const ABSENT = -32768;

export interface AttemptReplay {
  frames: number;
  frameS: number;
  /** Frames of start, exertion, peak and end. */
  keyframes: readonly number[];
  /** Frame by frame 17 times x, y, z in metres; world frame, z up. */
  positionsM: Float32Array;
  /** Frame by frame 17 states, as in a motion frame. */
  states: Uint8Array;
  /** Frame by frame 17 levels; grey wherever the state is not "seen". */
  levels: Uint8Array;
  /** The standard, in the same order as the positions and at the pupil's place; NaN where nothing is known. */
  standardM: Float32Array;
  /** Of the standard: seen where it has a place, unknown where it has none. */
  standardStates: Uint8Array;
}

export class AttemptReplayError extends Error {}

/** Reads one replay; throws an `AttemptReplayError` for anything else. */
export function readAttemptReplay(buffer: ArrayBuffer): AttemptReplay {
  const view = new DataView(buffer);
  if (buffer.byteLength < HEADER_BYTES || view.getUint32(0, true) !== MAGIC) {
    throw new AttemptReplayError(`${buffer.byteLength} bytes are no replay`);
  }
  if (view.getUint8(4) !== VERSION) throw new AttemptReplayError(`version ${view.getUint8(4)} is not known`);
  if (view.getUint8(5) !== JOINT_COUNT) throw new AttemptReplayError(`${view.getUint8(5)} joints are not 17`);
  const frames = view.getUint16(8, true);
  const count = frames * JOINT_COUNT;
  if (frames === 0 || buffer.byteLength !== HEADER_BYTES + count * (JOINT_BYTES + STANDARD_BYTES)) {
    throw new AttemptReplayError(`${buffer.byteLength} bytes do not hold ${frames} frames`);
  }
  const keyframes = Array.from({ length: KEYFRAMES }, (_, index) => view.getUint16(14 + 2 * index, true));
  if (keyframes.some((frame, index) => frame >= frames || frame < (keyframes[index - 1] ?? 0))) {
    throw new AttemptReplayError(`keyframes ${keyframes.join(', ')} do not follow one another within ${frames} frames`);
  }
  const replay: AttemptReplay = {
    frames,
    frameS: view.getUint32(10, true) * 1e-6,
    keyframes,
    positionsM: new Float32Array(3 * count),
    states: new Uint8Array(count),
    levels: new Uint8Array(count),
    standardM: new Float32Array(3 * count),
    standardStates: new Uint8Array(count),
  };
  if (replay.frameS === 0) throw new AttemptReplayError('frames follow one another in no time');
  for (let joint = 0; joint < count; joint++) readJoint(view, HEADER_BYTES + joint * JOINT_BYTES, joint, replay);
  const standardAt = HEADER_BYTES + count * JOINT_BYTES;
  for (let joint = 0; joint < count; joint++) readStandard(view, standardAt + joint * STANDARD_BYTES, joint, replay);
  return replay;
}

function readJoint(view: DataView, offset: number, joint: number, replay: AttemptReplay): void {
  for (let axis = 0; axis < 3; axis++) {
    replay.positionsM[3 * joint + axis] = view.getInt16(offset + 2 * axis, true) / 1000;
  }
  const state = view.getUint8(offset + 6);
  const level = view.getUint8(offset + 7);
  if (state > JointState.Seen) throw new AttemptReplayError(`a joint's state ${state} is not known`);
  if (level > Level.Red) throw new AttemptReplayError(`a joint's level ${level} is not known`);
  replay.states[joint] = state;
  // Whatever the box may say: what was not seen has no colour.
  replay.levels[joint] = state === JointState.Seen ? level : Level.Grey;
}

function readStandard(view: DataView, offset: number, joint: number, replay: AttemptReplay): void {
  const place = [0, 1, 2].map((axis) => view.getInt16(offset + 2 * axis, true));
  const known = !place.includes(ABSENT);
  replay.standardM.set(
    place.map((mm) => (known ? mm / 1000 : NaN)),
    3 * joint,
  );
  replay.standardStates[joint] = known ? JointState.Seen : JointState.Unknown;
}
