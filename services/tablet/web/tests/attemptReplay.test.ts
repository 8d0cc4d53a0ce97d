import { readFileSync } from 'node:fs';
import { describe, expect, it } from 'vitest';
import { AttemptReplayError, Level, readAttemptReplay } from '../src/protocol/attemptReplay';
import { JointState } from '../src/protocol/motionFrame';

const FOLDER = new URL('../../../../tests/golden/attempt_replay/', import.meta.url);

interface Vector {
  frame_us: number;
  keyframes: number[];
  positions_mm: number[][][];
  states: number[][];
  colours: number[][];
  standard_mm: (number[] | null)[][];
}

function bytes(name: string): ArrayBuffer {
  const file = readFileSync(new URL(`${name}.bin`, FOLDER));
  return file.buffer.slice(file.byteOffset, file.byteOffset + file.byteLength) as ArrayBuffer;
}

const mm = (values: Float32Array): number[] => Array.from(values, (metres) => Math.round(1000 * metres));

describe("an attempt's replay", () => {
  it.each(['jump', 'extremes', 'grey'])('is read as the golden file %s says', (name) => {
    const said = JSON.parse(readFileSync(new URL(`${name}.json`, FOLDER), 'utf-8')) as Vector;
    const replay = readAttemptReplay(bytes(name));
    expect(replay.frames).toBe(said.states.length);
    expect(replay.frameS).toBeCloseTo(said.frame_us * 1e-6, 9);
    expect(replay.keyframes).toEqual(said.keyframes);
    expect(mm(replay.positionsM)).toEqual(said.positions_mm.flat(2));
    expect([...replay.states]).toEqual(said.states.flat());
    const seen = said.states.flat().map((state) => state === JointState.Seen);
    expect([...replay.levels]).toEqual(said.colours.flat().map((colour, i) => (seen[i] ? colour : Level.Grey)));
    const standard = said.standard_mm.flat().flatMap((place) => place ?? [NaN, NaN, NaN]);
    expect(mm(replay.standardM)).toEqual(standard);
    const known = said.standard_mm.flat().map((place) => (place === null ? JointState.Unknown : JointState.Seen));
    expect([...replay.standardStates]).toEqual(known);
  });

  it('is never coloured where a joint was not seen, whatever the box says', () => {
    const damaged = bytes('jump');
    const view = new DataView(damaged);
    for (let joint = 0; joint < 17; joint++) {
      view.setUint8(22 + 8 * joint + 6, JointState.Guessed);
      view.setUint8(22 + 8 * joint + 7, Level.Green);
    }
    expect(Math.max(...readAttemptReplay(damaged).levels.slice(0, 17))).toBe(Level.Grey);
  });

  it.each([
    ['another magic', 0, 88],
    ['another version', 4, 2],
    ['another number of joints', 5, 24],
    ['another number of frames', 8, 9],
    ['a frame that takes no time', 10, 0],
    ['a keyframe behind the end', 20, 6],
    ['keyframes in another order', 14, 5],
    ['an unknown state', 28, 3],
    ['an unknown colour', 29, 4],
  ])('is refused with %s', (name, offset, value) => {
    const damaged = bytes('jump');
    new Uint8Array(damaged)[offset] = value;
    if (name === 'a frame that takes no time') new Uint8Array(damaged).fill(0, 10, 14);
    expect(() => readAttemptReplay(damaged)).toThrow(AttemptReplayError);
  });

  it('is refused when it is cut off, anywhere', () => {
    const whole = bytes('jump');
    for (const length of [0, 3, 21, 22, 100, whole.byteLength - 1]) {
      expect(() => readAttemptReplay(whole.slice(0, length))).toThrow(AttemptReplayError);
    }
  });
});
