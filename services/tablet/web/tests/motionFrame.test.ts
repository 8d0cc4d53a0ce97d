import { readFileSync } from 'node:fs';
import { describe, expect, it } from 'vitest';
import { FRAME_BYTES, MotionFrameError, readMotionFrame } from '../src/protocol/motionFrame';

const FOLDER = new URL('../../../../tests/golden/motion_frame/', import.meta.url);

interface Vector {
  kind: string;
  sequence: number;
  epoch: number;
  t_ns: string;
  t_newest_ns: string;
  server_latency_us: number;
  out_of_range: boolean;
  positions_mm: number[][];
  sigma_mm: number[];
  states: number[];
  views: number[];
}

function bytes(name: string): ArrayBuffer {
  const file = readFileSync(new URL(`${name}.bin`, FOLDER));
  return file.buffer.slice(file.byteOffset, file.byteOffset + file.byteLength) as ArrayBuffer;
}

describe('motion frames', () => {
  it.each(['walking', 'extremes', 'nobody'])('are read as the golden file %s says', (name) => {
    const said = JSON.parse(readFileSync(new URL(`${name}.json`, FOLDER), 'utf-8')) as Vector;
    const frame = readMotionFrame(bytes(name));
    expect(frame.kind).toBe(said.kind);
    expect(frame.sequence).toBe(said.sequence);
    expect(frame.epoch).toBe(said.epoch);
    expect(frame.tNs).toBe(BigInt(said.t_ns));
    expect(frame.tNewestNs).toBe(BigInt(said.t_newest_ns));
    expect(frame.serverLatencyUs).toBe(said.server_latency_us);
    expect(frame.outOfRange).toBe(said.out_of_range);
    expect(Array.from(frame.positionsM, (metres) => Math.round(1000 * metres))).toEqual(said.positions_mm.flat());
    expect([...frame.sigmaMm]).toEqual(said.sigma_mm);
    expect([...frame.states]).toEqual(said.states);
    expect([...frame.views]).toEqual(said.views);
  });

  it.each([
    ['another magic', 0, 88],
    ['another version', 4, 2],
    ['an unknown kind', 5, 9],
    ['another number of joints', 6, 24],
    ['an unknown state', 44, 3],
  ])('are refused with %s', (_name, offset, value) => {
    const damaged = bytes('walking');
    new Uint8Array(damaged)[offset] = value;
    expect(() => readMotionFrame(damaged)).toThrow(MotionFrameError);
  });

  it('are refused at any other length', () => {
    expect(() => readMotionFrame(new ArrayBuffer(0))).toThrow(MotionFrameError);
    expect(() => readMotionFrame(bytes('walking').slice(0, FRAME_BYTES - 1))).toThrow(MotionFrameError);
  });
});
