import { describe, expect, it } from 'vitest';
import { BoxClock } from '../src/connection/boxClock';
import { figureAgeMs, Freshness, HALTED_AFTER_MS, STALE_AFTER_MS, underWayMs } from '../src/connection/freshness';
import { makerOf, phaseOf, type PhaseInputs } from '../src/connection/phase';
import { reconnectDelayMs } from '../src/connection/reconnect';
import type { ProcessStatus } from '../src/protocol/messages';
import type { MotionFrame } from '../src/protocol/motionFrame';

function frame(tNewestMs: number, serverLatencyMs = 100): MotionFrame {
  return {
    kind: 'live',
    sequence: 0,
    epoch: 0,
    tNs: 0n,
    tNewestNs: BigInt(tNewestMs) * 1_000_000n,
    serverLatencyUs: serverLatencyMs * 1000,
    outOfRange: false,
    positionsM: new Float32Array(51),
    sigmaMm: new Uint16Array(17),
    states: new Uint8Array(17),
    views: new Uint8Array(17),
  };
}

describe('the age of the figure', () => {
  it('counts from the instant shown, which is older than the newest picture used', () => {
    expect(figureAgeMs({ ...frame(1000), tNs: 940_000_000n }, 1080)).toBe(140);
  });

  it('counts from the newest picture where the figure is foretold', () => {
    expect(figureAgeMs({ ...frame(1000), tNs: 1_030_000_000n }, 1080)).toBe(80);
  });
});

describe('reconnecting', () => {
  it('waits 250 ms at first and never longer than 5 s', () => {
    expect(reconnectDelayMs(0, 0)).toBe(250);
    for (let failures = 0; failures < 60; failures++) {
      for (const random of [0, 0.5, 0.999]) {
        expect(reconnectDelayMs(failures, random)).toBeGreaterThanOrEqual(250);
        expect(reconnectDelayMs(failures, random)).toBeLessThanOrEqual(5000);
      }
    }
  });

  it('is there within half a second of a server that is back after three', () => {
    for (let waitedMs = 0, failures = 0; waitedMs < 3000; failures++) {
      expect(reconnectDelayMs(failures, 0.999)).toBeLessThanOrEqual(500);
      waitedMs += reconnectDelayMs(failures, 0.999);
    }
  });

  it('waits ever longer for a box that is switched off', () => {
    const delays = [7, 8, 9, 10, 11].map((failures) => reconnectDelayMs(failures, 0.5));
    expect(delays).toEqual([...delays].sort((a, b) => a - b));
    expect(delays.at(-1)).toBeGreaterThan(3000);
  });

  it('spreads the tablets of a school over half of the time', () => {
    expect(reconnectDelayMs(19, 0.999) - reconnectDelayMs(19, 0)).toBeGreaterThan(2400);
  });
});

describe("the box's clock", () => {
  it('is not known before the first answer', () => {
    expect(new BoxClock().boxMs(0)).toBeNull();
    expect(new BoxClock().roundTripMs).toBeNull();
  });

  it('is measured however wrong the clock of the tablet is', () => {
    const clock = new BoxClock();
    clock.addPong(1000, 9_000_010, 1020);
    expect(clock.boxMs(2000)).toBe(9_001_000);
  });

  it('believes the quickest answer and not the newest', () => {
    const clock = new BoxClock();
    clock.addPong(0, 5, 10);
    clock.addPong(1000, 1300, 1400);
    expect(clock.boxMs(2000)).toBe(2000);
    expect(clock.roundTripMs).toBe(400);
  });

  it('forgets with the connection', () => {
    const clock = new BoxClock();
    clock.addPong(0, 5, 10);
    clock.reset();
    expect(clock.boxMs(0)).toBeNull();
  });
});

describe('freshness', () => {
  it('begins stale: no data must never look fine', () => {
    expect(new Freshness().isStale(0)).toBe(true);
  });

  it('ends 1.5 s after the exposure, not after the arrival', () => {
    const freshness = new Freshness();
    freshness.note(frame(1, 400), 10_000);
    expect(freshness.isStale(9_600 + STALE_AFTER_MS)).toBe(false);
    expect(freshness.isStale(9_601 + STALE_AFTER_MS)).toBe(true);
  });

  it('takes the colour of a figure that stands still long before it is called interrupted', () => {
    const freshness = new Freshness();
    expect(freshness.isHalted(0)).toBe(true);
    freshness.note(frame(1, 100), 10_000);
    expect(freshness.isHalted(9_900 + HALTED_AFTER_MS)).toBe(false);
    expect(freshness.isHalted(9_901 + HALTED_AFTER_MS)).toBe(true);
    expect(freshness.isStale(9_901 + HALTED_AFTER_MS)).toBe(false);
  });

  it('is not renewed by frames that repeat an old observation', () => {
    const freshness = new Freshness();
    for (let nowMs = 0; nowMs <= 3000; nowMs += 33) freshness.note(frame(1, 100), nowMs);
    expect(freshness.isStale(3000)).toBe(true);
  });

  it('knows how long a frame was under way only with the clock of the box', () => {
    expect(underWayMs(frame(5000, 100), null)).toBeNull();
    expect(underWayMs(frame(5000, 100), 5130)).toBe(30);
  });
});

describe('the phase', () => {
  const live: PhaseInputs = {
    connected: true,
    everConnected: true,
    failures: 0,
    replayEnded: false,
    hasFigure: true,
    stale: false,
    maker: 'works',
    dropping: false,
    nobody: false,
  };

  it.each<[string, Partial<PhaseInputs>, string]>([
    ['a lesson that was played to its end', { connected: false, replayEnded: true }, 'ended'],
    ['another lesson after one that ended', { replayEnded: true }, 'live'],
    ['fresh motion', {}, 'live'],
    ['no connection yet', { connected: false, everConnected: false }, 'connecting'],
    ['several failures', { connected: false, everConnected: false, failures: 3 }, 'offline'],
    ['a connection that broke', { connected: false }, 'offline'],
    ['no figure yet: whether somebody is there is not known', { hasFigure: false, stale: true }, 'searching'],
    ['no figure, and nobody was found', { hasFigure: false, stale: true, nobody: true }, 'waiting'],
    ['a figure that became old', { stale: true }, 'stale'],
    ['a fresh figure whose maker has just died', { maker: 'interrupted' }, 'stale'],
    ['a maker that is given up', { maker: 'failed' }, 'failed'],
    [
      'a maker that is given up before there was a figure',
      { maker: 'failed', hasFigure: false, stale: true },
      'failed',
    ],
    ['a pupil who left', { stale: true, nobody: true }, 'waiting'],
    ['frames that are all too late', { stale: true, dropping: true }, 'late'],
    ['frames that were too late before their maker died', { dropping: true, maker: 'interrupted' }, 'stale'],
  ])('with %s', (_name, change, phase) => {
    expect(phaseOf({ ...live, ...change })).toBe(phase);
  });
});

describe('what makes the figure', () => {
  const said = (state: ProcessStatus['state'], name = 'fusion') => ({
    processes: [{ name, state, reason: '', age_s: 0, cpu_cores: 0, rss_mib: 0, restarts: 0 }],
  });

  it('is missed as soon as the box says that it is gone or hangs', () => {
    const states = ['gone', 'silent', 'unknown'] as const;
    expect(states.map((state) => makerOf(said(state)))).toEqual(['interrupted', 'interrupted', 'interrupted']);
  });

  it('is missed while it gets ready again', () => {
    expect(makerOf(said('starting'))).toBe('interrupted');
  });

  it('is given up only if the box says so', () => {
    expect(makerOf(said('failed'))).toBe('failed');
  });

  it('is not missed while it works, before it was heard, or for a camera that is gone', () => {
    expect(makerOf(null)).toBe('works');
    expect(makerOf({ processes: [] })).toBe('works');
    expect(makerOf(said('degraded'))).toBe('works');
    expect(makerOf(said('failed', 'edge-cam01'))).toBe('works');
  });
});
