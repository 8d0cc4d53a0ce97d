import { describe, expect, it } from 'vitest';
import type { Attempt, AttemptMeasure, Status } from '../src/protocol/messages';
import { isJudging } from '../src/state/evaluation';
import { gauge } from '../src/state/gauge';
import { Lesson } from '../src/state/lesson.svelte';

const attempt = (id: number, ended_ms = 1000 * id): Attempt => ({
  type: 'attempt',
  id,
  action: 'squat',
  by: 'chosen',
  handed: 'right',
  ended_ms,
  duration_s: 2,
  score: 80,
  score_sigma: 4,
  cue: null,
  cue_certainty: null,
  praise: null,
  measures: [],
});

describe('attempts', () => {
  it('are listed with the newest first, counted from the first', () => {
    const lesson = new Lesson();
    for (const id of [1, 2, 3]) lesson.note(attempt(id), null);
    expect(lesson.attempts.map(({ number, attempt: { id } }) => [number, id])).toEqual([
      [3, 3],
      [2, 2],
      [1, 1],
    ]);
    expect(lesson.shown?.number).toBe(3);
  });

  it('are news when they have just ended, once, and by the clock of the box', () => {
    const lesson = new Lesson();
    expect(lesson.note(attempt(1), 2000)).toBe(true);
    expect(lesson.note(attempt(1), 2000)).toBe(false);
    expect(lesson.note(attempt(2), 600_000)).toBe(false);
    expect(lesson.note(attempt(3), null)).toBe(false);
    expect(lesson.attempts).toHaveLength(3);
  });

  it('are kept as long as the box keeps them, and keep their numbers', () => {
    const lesson = new Lesson();
    for (let id = 1; id <= 60; id++) lesson.note(attempt(id), null);
    expect(lesson.attempts).toHaveLength(50);
    expect(lesson.attempts.at(-1)?.number).toBe(11);
  });

  it('that are looked at stay so when another one ends', () => {
    const lesson = new Lesson();
    lesson.note(attempt(1), null);
    lesson.show(1);
    lesson.note(attempt(2), null);
    expect(lesson.shown?.attempt.id).toBe(1);
    expect(lesson.isNewest).toBe(false);
    lesson.show(null);
    expect(lesson.shown?.attempt.id).toBe(2);
    expect(lesson.isNewest).toBe(true);
  });
});

describe('the activity', () => {
  it('is what was asked for until the box has confirmed it', () => {
    const lesson = new Lesson();
    expect(lesson.activity('run')).toBe('run');
    lesson.ask('squat', 0);
    expect(lesson.activity('run')).toBe('squat');
    lesson.confirm('run', 500); // a status that was under way
    expect(lesson.activity('run')).toBe('squat');
    lesson.confirm('squat', 900);
    expect(lesson.activity('run')).toBe('run');
  });

  it('is what the box says when it does not do what it was asked for', () => {
    const lesson = new Lesson();
    lesson.ask(null, 0);
    expect(lesson.activity('run')).toBeNull();
    lesson.confirm('run', 60_000);
    expect(lesson.activity('run')).toBe('run');
  });
});

describe('what judges attempts', () => {
  const said = (state: Status['processes'][number]['state'], name = 'evaluation'): Pick<Status, 'processes'> => ({
    processes: [{ name, state, reason: '', age_s: 0, cpu_cores: 0, rss_mib: 0, restarts: 0 }],
  });

  it('is at work only if the box says so', () => {
    expect(['ok', 'degraded', 'starting'].map((state) => isJudging(said(state as 'ok')))).toEqual([true, true, true]);
    const away = ['failed', 'silent', 'gone', 'unknown'].map((state) => isJudging(said(state as 'failed')));
    expect(away).toEqual([false, false, false, false]);
    expect(isJudging(said('ok', 'fusion'))).toBe(false);
    expect(isJudging(null)).toBe(false);
  });
});

describe('the line beside a measure', () => {
  const measure = (change: Partial<AttemptMeasure>) => gauge({ value: 60, sigma: 4, low: 50, high: 80, ...change });

  it('puts a value between its bounds inside of the band', () => {
    const drawn = measure({})!;
    expect(drawn.at).toBeGreaterThan(drawn.bandFrom);
    expect(drawn.at).toBeLessThan(drawn.bandTo);
  });

  it('puts it outside when it is, however far', () => {
    expect(measure({ value: 10 })!.at).toBeLessThan(measure({ value: 10 })!.bandFrom);
    expect(measure({ value: 400 })!.at).toBeGreaterThan(measure({ value: 400 })!.bandTo);
  });

  it('goes on for ever where there is no bound', () => {
    expect(measure({ high: null })!.bandTo).toBe(100);
    expect(measure({ low: null })!.bandFrom).toBe(0);
    expect(measure({ high: null, value: 20 })!.at).toBeLessThan(measure({ high: null, value: 20 })!.bandFrom);
  });

  it('is not there without a value, or without a bound', () => {
    expect(measure({ value: null, sigma: null })).toBeNull();
    expect(measure({ low: null, high: null })).toBeNull();
  });

  it('stays on the page whatever the numbers are', () => {
    for (const change of [{ value: 0, low: 0, high: 0 }, { value: 1e9 }, { sigma: 1e9 }, { value: -1e9, high: null }]) {
      for (const place of Object.values(measure(change)!)) {
        expect(place).toBeGreaterThanOrEqual(0);
        expect(place).toBeLessThanOrEqual(100);
      }
    }
  });
});
