import { describe, expect, it } from 'vitest';
import { boxIsLate, isDistant, Lateness } from '../src/connection/lateness';
import type { CameraStatus, MachineStatus, Status } from '../src/protocol/messages';

type Load = Parameters<typeof boxIsLate>[0];

const slow: CameraStatus = {
  name: 'cam0',
  state: 'slow',
  reason: 'behind',
  detail: '',
  source_hz: 30,
  fresh_hz: 5,
  target_hz: 10,
  backlog_ms: 20,
  skipped: 0,
  used: true,
  network: 'thunder',
};
const calm: Load = {
  cameras: [{ ...slow, state: 'ok', reason: 'none' }],
  cpu_load: 0.4,
  latency: { p50_ms: 140, p95_ms: 200 },
  machine: null,
  replay: null,
};
const machine = (used_cores: number): MachineStatus => ({
  used_cores,
  granted_cores: 4,
  memory_free_mib: 3000,
  disk_free_mib: 40_000,
  temperature_c: null,
  clock_ms: 0,
  clock_step_ms: 0,
  troubles: [],
});
const replay: Status['replay'] = { title: '', began_ms: 0, speed: 1, position_s: 3, length_s: 9 };

describe('a box that is late', () => {
  it.each<[string, Partial<Load>, boolean]>([
    ['nothing is wrong', {}, false],
    ['nothing is known', { cameras: [], cpu_load: null, latency: null }, false],
    ['its processor is full', { cpu_load: 0.95 }, true],
    ['others fill its processor', { machine: machine(3.9) }, true],
    ['its machine has room', { machine: machine(2.9) }, false],
    ['its cameras are behind', { cameras: [slow, slow] }, true],
    ['figures are old before they are sent', { latency: { p50_ms: 900, p95_ms: 1200 } }, true],
    ['cameras were behind in the lesson that is played', { cameras: [slow], replay }, false],
  ])('is told when %s', (_name, change, late) => {
    expect(boxIsLate({ ...calm, ...change })).toBe(late);
  });
});

describe('who is to blame for pictures that come too late', () => {
  const cause = (change: Partial<Load>, lateMs = 0, distant = true): string => {
    const lateness = new Lateness(distant);
    lateness.noteStatus({ ...calm, ...change }, 1000);
    lateness.noteTurn(lateMs, 1000);
    return lateness.cause(1100);
  };

  it('is the box before all others', () => {
    expect(cause({ cpu_load: 1 }, 900)).toBe('box');
  });

  it('is a tablet whose turns come too late', () => {
    expect(cause({}, 400)).toBe('tablet');
  });

  it('is the network only where both keep up and there is one', () => {
    expect(cause({})).toBe('network');
    expect(cause({}, 0, false)).toBe('unknown');
  });

  it('is not known as long as the box has said nothing', () => {
    expect(new Lateness(true).cause(0)).toBe('unknown');
  });

  it('does not flicker with the load, and is judged anew after a while', () => {
    const lateness = new Lateness(true);
    lateness.noteStatus({ ...calm, cpu_load: 1 }, 1000);
    lateness.noteStatus(calm, 1500);
    expect(lateness.cause(3000)).toBe('box');
    expect(lateness.cause(7000)).toBe('network');
  });
});

it('a page on the box itself comes over no network', () => {
  expect(['localhost', '127.0.0.1', '[::1]'].map(isDistant)).toEqual([false, false, false]);
  expect(['192.168.1.20', 'kinebox.local'].map(isDistant)).toEqual([true, true]);
});
