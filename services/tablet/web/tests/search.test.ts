import { describe, expect, it } from 'vitest';
import type { CameraStatus, Status } from '../src/protocol/messages';
import { LOOKED_FOR_MS, Search } from '../src/state/search';

type Look = Parameters<Search['note']>[0];

const camera = (state: CameraStatus['state'], fresh_hz = 15): CameraStatus => ({
  name: '',
  state,
  reason: 'none',
  detail: '',
  source_hz: 30,
  fresh_hz,
  target_hz: 15,
  backlog_ms: 20,
  skipped: 0,
  used: false,
  network: 'thunder',
});
const look = (pupil: Status['pupil'], ...cameras: CameraStatus[]): Look => ({ pupil, cameras });
const two = [camera('ok'), camera('slow')];

function inVain(...looks: Look[]): boolean {
  const search = new Search();
  looks.forEach((each, index) => search.note(each, 1000 * index));
  return search.inVain(1000 * (looks.length - 1));
}
const seconds = (count: number, each: Look): Look[] => Array.from({ length: count + 1 }, () => each);
const enough = LOOKED_FOR_MS / 1000;

describe('nobody is in view', () => {
  it('after the box has looked for a while with two cameras', () => {
    expect(inVain(...seconds(enough, look('searching', ...two)))).toBe(true);
  });

  it('is not said of a page that was just opened or a box that was just restarted', () => {
    expect(inVain()).toBe(false);
    expect(inVain(...seconds(enough - 1, look('searching', ...two)))).toBe(false);
    expect(inVain(...seconds(9, look('unknown', ...two)))).toBe(false);
  });

  it('is not said while cameras are blind', () => {
    expect(inVain(...seconds(9, look('searching', camera('ok'), camera('lost'))))).toBe(false);
    expect(inVain(...seconds(9, look('searching', camera('ok'), camera('ok', 0))))).toBe(false);
  });

  it('is not said as soon as somebody is found, and the search begins anew', () => {
    const searching = seconds(enough, look('searching', ...two));
    expect(inVain(...searching, look('found', ...two))).toBe(false);
    expect(inVain(...searching, look('found', ...two), look('searching', ...two))).toBe(false);
  });
});
