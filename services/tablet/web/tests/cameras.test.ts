import { describe, expect, it } from 'vitest';
import type { CameraStatus } from '../src/protocol/messages';
import { boxIsBusy, gettingReady, givenUp, slowCameras } from '../src/state/cameras';

const camera = (changes: Partial<CameraStatus>): CameraStatus => ({
  name: 'cam0',
  state: 'slow',
  reason: 'sparse',
  detail: '',
  source_hz: 30,
  fresh_hz: 5,
  target_hz: 5,
  backlog_ms: 20,
  skipped: 0,
  used: true,
  network: 'thunder',
  ...changes,
});

describe('cameras that get ready', () => {
  it('are so while none works yet', () => {
    expect(gettingReady([camera({ state: 'starting' }), camera({ state: 'starting' })])).toBe(true);
    expect(gettingReady([camera({ state: 'starting' }), camera({ state: 'lost' })])).toBe(true);
  });

  it('are not so once one works, or when all are lost', () => {
    expect(gettingReady([camera({ state: 'starting' }), camera({ state: 'ok' })])).toBe(false);
    expect(gettingReady([camera({ state: 'lost' })])).toBe(false);
    expect(gettingReady([])).toBe(false);
  });
});

describe('a busy box', () => {
  it('makes all cameras slow', () => {
    expect(boxIsBusy([camera({}), camera({ reason: 'behind' })])).toBe(true);
    expect(boxIsBusy([camera({}), camera({ state: 'ok', reason: 'none' })])).toBe(false);
    expect(boxIsBusy([])).toBe(false);
  });

  it('is not blamed for cameras that send few pictures or fail', () => {
    expect(boxIsBusy([camera({}), camera({ source_hz: 5 })])).toBe(false);
    expect(boxIsBusy([camera({}), camera({ reason: 'degraded' })])).toBe(false);
  });
});

it('cameras that the box does not look at often enough are told from those that are slow by themselves', () => {
  const cameras = [camera({}), camera({ source_hz: 5 }), camera({ state: 'ok' }), camera({ reason: 'behind' })];
  expect(slowCameras(cameras)).toEqual({ byThemselves: [2], byTheBox: [1, 4] });
});

it('cameras that are given up are told from those that come back', () => {
  const lost = (reason: CameraStatus['reason']): CameraStatus => camera({ state: 'lost', reason });
  expect(givenUp([lost('given_up'), lost('process_gone'), camera({}), lost('given_up')])).toEqual([1, 4]);
});
