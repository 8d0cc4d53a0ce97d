/**
 * Reads the binary motion frame; the layout is described in `services/tablet/motion_frame.py` and held to the vectors in
 * `tests/golden/motion_frame`.
 */

export const JOINT_COUNT = 17;
export const FRAME_BYTES = 206;

/** How much a joint may be believed. Only `Seen` may ever be drawn in a colour other than grey. */
export const JointState = { Unknown: 0, Guessed: 1, Seen: 2 } as const;

const MAGIC = 0x464d424b; // "KBMF", read as a little-endian number
const VERSION = 1;
const KINDS = ['live', 'smooth'] as const;
const OUT_OF_RANGE = 1;
const HEADER_BYTES = 36;
const JOINT_BYTES = 10;

export interface MotionFrame {
  kind: (typeof KINDS)[number];
  sequence: number;
  epoch: number;
  /** Box clock, nanoseconds: the instant described. */
  tNs: bigint;
  /** Box clock, nanoseconds: mid-exposure of the newest observation used. */
  tNewestNs: bigint;
  /** From `tNewestNs` until the server packed the frame. */
  serverLatencyUs: number;
  /** A joint did not fit into the layout and is unknown here. */
  outOfRange: boolean;
  /** 17 times x, y, z in metres; world frame, z up. */
  positionsM: Float32Array;
  sigmaMm: Uint16Array;
  states: Uint8Array;
  /** Bit i: camera i agreed. */
  views: Uint8Array;
}

export class MotionFrameError extends Error {}

/** Reads one frame; throws a `MotionFrameError` for anything else. */
export function readMotionFrame(buffer: ArrayBuffer): MotionFrame {
  if (buffer.byteLength !== FRAME_BYTES) throw new MotionFrameError(`${buffer.byteLength} bytes are no motion frame`);
  const view = new DataView(buffer);
  if (view.getUint32(0, true) !== MAGIC) throw new MotionFrameError('the magic is missing');
  if (view.getUint8(4) !== VERSION) throw new MotionFrameError(`version ${view.getUint8(4)} is not known`);
  const kind = KINDS[view.getUint8(5)];
  if (kind === undefined) throw new MotionFrameError(`kind ${view.getUint8(5)} is not known`);
  if (view.getUint8(6) !== JOINT_COUNT) throw new MotionFrameError(`${view.getUint8(6)} joints are not 17`);

  const frame: MotionFrame = {
    kind,
    sequence: view.getUint32(8, true),
    epoch: view.getUint32(12, true),
    tNs: view.getBigInt64(16, true),
    tNewestNs: view.getBigInt64(24, true),
    serverLatencyUs: view.getUint32(32, true),
    outOfRange: (view.getUint8(7) & OUT_OF_RANGE) !== 0,
    positionsM: new Float32Array(3 * JOINT_COUNT),
    sigmaMm: new Uint16Array(JOINT_COUNT),
    states: new Uint8Array(JOINT_COUNT),
    views: new Uint8Array(JOINT_COUNT),
  };
  for (let joint = 0; joint < JOINT_COUNT; joint++) readJoint(view, HEADER_BYTES + joint * JOINT_BYTES, joint, frame);
  return frame;
}

function readJoint(view: DataView, offset: number, joint: number, frame: MotionFrame): void {
  for (let axis = 0; axis < 3; axis++) {
    frame.positionsM[3 * joint + axis] = view.getInt16(offset + 2 * axis, true) / 1000;
  }
  frame.sigmaMm[joint] = view.getUint16(offset + 6, true);
  const state = view.getUint8(offset + 8);
  if (state > JointState.Seen) throw new MotionFrameError(`a joint's state ${state} is not known`);
  frame.states[joint] = state;
  frame.views[joint] = view.getUint8(offset + 9);
}
