import { readFileSync } from 'node:fs';
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import type { Attempt } from '../src/protocol/messages';
import { HELD_MS, LOOKED_AT_MS, PATIENCE_MS, Replays } from '../src/replay/replays';
import { ReplayShow } from '../src/replay/show.svelte';
import type { Stage } from '../src/stage/stage';

const JUMP = readFileSync(new URL('../../../../tests/golden/attempt_replay/jump.bin', import.meta.url));
const attempt = { id: 7, handed: 'right' } as Attempt;

/** A stage on which nothing is drawn. */
const stage = (): Stage =>
  ({
    beginAttempt: vi.fn(),
    endAttempt: vi.fn(),
    frameAttempt: vi.fn(),
    showAttempt: vi.fn(),
    requestDraw: vi.fn(),
    mirror: vi.fn(),
  }) as unknown as Stage;

function looked(reducedMotion = false) {
  vi.stubGlobal('matchMedia', () => ({ matches: reducedMotion }));
  const show = new ReplayShow();
  const unreadable = vi.fn();
  return { show, unreadable, replays: new Replays(show, stage(), vi.fn(), unreadable) };
}

const answered = (body: BodyInit | null, status = 200) => vi.fn(async () => new Response(body, { status }));

beforeEach(() => void vi.useFakeTimers());
afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

describe('a replay', () => {
  it('is shown when it arrives, and asks the box for nothing the second time', async () => {
    const fetched = answered(JUMP);
    vi.stubGlobal('fetch', fetched);
    const { show, replays } = looked();
    for (let time = 0; time < 2; time++) {
      await replays.start(attempt);
      expect([show.phase, show.id, show.hasStandard]).toEqual(['shown', 7, true]);
      replays.stop();
    }
    expect(fetched).toHaveBeenCalledTimes(1);
  });

  it('that was looked at can be seen without the box, as long as its attempt is on the list', async () => {
    vi.stubGlobal('fetch', answered(JUMP));
    const { show, replays } = looked();
    for (const id of [7, 8]) await replays.start({ ...attempt, id });
    expect([...show.kept]).toEqual([7, 8]);
    const fetched = vi.fn(async () => {
      throw new TypeError('no network');
    });
    vi.stubGlobal('fetch', fetched);
    await replays.start(attempt);
    expect([show.phase, show.id, fetched.mock.calls.length]).toEqual(['shown', 7, 0]);
    replays.keepOnly(new Set([8, 9]));
    expect([...show.kept]).toEqual([8]);
    await replays.start(attempt);
    expect(show.phase).toBe('failed');
  });

  it('is no longer there if the box says so, and only then', async () => {
    vi.stubGlobal('fetch', answered('', 404));
    const { show, replays } = looked();
    await replays.start(attempt);
    expect(show.phase).toBe('missing');
    vi.stubGlobal('fetch', answered('', 500));
    await replays.start(attempt);
    expect(show.phase).toBe('failed');
  });

  it('that did not arrive can be asked for again', async () => {
    const fetched = vi.fn(async () => {
      throw new TypeError('no network');
    });
    vi.stubGlobal('fetch', fetched);
    const { show, replays, unreadable } = looked();
    await replays.start(attempt);
    expect([show.phase, show.id]).toEqual(['failed', 7]);
    expect(unreadable).not.toHaveBeenCalled();
    vi.stubGlobal('fetch', answered(JUMP));
    replays.again();
    await vi.waitFor(() => expect(show.phase).toBe('shown'));
  });

  it('that hangs has failed after a while', async () => {
    vi.stubGlobal(
      'fetch',
      (_: string, { signal }: { signal: AbortSignal }) =>
        new Promise((_resolve, reject) => signal.addEventListener('abort', () => reject(new Error('aborted')))),
    );
    const { show, replays } = looked();
    const started = replays.start(attempt);
    await vi.advanceTimersByTimeAsync(PATIENCE_MS - 1);
    expect(show.phase).toBe('loading');
    await vi.advanceTimersByTimeAsync(1);
    await started;
    expect(show.phase).toBe('failed');
  });

  it('that cannot be read is counted, and can be asked for again', async () => {
    vi.stubGlobal('fetch', answered(JUMP.subarray(0, 100)));
    const { show, replays, unreadable } = looked();
    await replays.start(attempt);
    expect(show.phase).toBe('failed');
    expect(unreadable).toHaveBeenCalledTimes(1);
  });

  it('that arrives after something else was asked for is not shown', async () => {
    const answers: ((response: Response) => void)[] = [];
    vi.stubGlobal('fetch', () => new Promise<Response>((resolve) => answers.push(resolve)));
    const { show, replays } = looked();
    const first = replays.start(attempt);
    const second = replays.start({ ...attempt, id: 8 });
    answers[1]!(new Response(JUMP));
    await second;
    answers[0]!(new Response('', { status: 500 }));
    await first;
    expect([show.phase, show.id]).toEqual(['shown', 8]);
    const third = replays.start({ ...attempt, id: 9 });
    replays.stop();
    answers[2]!(new Response(JUMP));
    await third;
    expect(show.phase).toBe('off');
  });
});

describe('the end of a replay', () => {
  /** The pupil begins to move now. */
  const over = (replays: Replays): boolean => replays.isOver(performance.now(), performance.now());

  it('comes with whoever moved on in its first round and has not stopped since', async () => {
    vi.stubGlobal('fetch', answered(JUMP));
    const { replays } = looked();
    const beforeMs = performance.now();
    await vi.advanceTimersByTimeAsync(100);
    await replays.start(attempt);
    await vi.advanceTimersByTimeAsync(100);
    const sinceMs = performance.now();
    for (let i = 0; i < 200 && replays.rounds === 0; i++) {
      expect(replays.isOver(performance.now(), sinceMs)).toBe(false);
      replays.draw(0.1);
    }
    expect(replays.isOver(performance.now(), sinceMs)).toBe(true);
    expect(replays.isOver(performance.now(), beforeMs)).toBe(false); // that is how he ended
  });

  it('is none where there is no replay or while it is on its way, and comes at once where it did not arrive', async () => {
    vi.stubGlobal('fetch', answered('', 500));
    const { replays, show } = looked();
    expect(over(replays)).toBe(false);
    const started = replays.start(attempt);
    expect([show.phase, over(replays)]).toEqual(['loading', false]);
    await started;
    expect([show.phase, over(replays)]).toEqual(['failed', true]);
  });

  it('is not before it was played once', async () => {
    vi.stubGlobal('fetch', answered(JUMP));
    const { replays } = looked();
    await replays.start(attempt);
    expect(over(replays)).toBe(false);
    for (let i = 0; i < 200 && replays.rounds === 0; i++) replays.draw(0.1);
    expect(over(replays)).toBe(true);
  });

  it('leaves whoever wants no motion some seconds for the decisive moment', async () => {
    vi.stubGlobal('fetch', answered(JUMP));
    const { replays, show } = looked(true);
    await replays.start(attempt);
    expect(show.playing).toBe(false);
    expect(over(replays)).toBe(false); // he walks back
    await vi.advanceTimersByTimeAsync(LOOKED_AT_MS);
    expect(over(replays)).toBe(true);
  });

  it('waits for whoever has touched it a moment ago', async () => {
    vi.stubGlobal('fetch', answered(JUMP));
    const { replays } = looked();
    await replays.start(attempt);
    replays.toggle();
    await vi.advanceTimersByTimeAsync(HELD_MS - 1);
    expect(over(replays)).toBe(false);
    await vi.advanceTimersByTimeAsync(1);
    expect(over(replays)).toBe(true);
  });
});
