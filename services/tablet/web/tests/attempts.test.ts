import { describe, expect, it } from 'vitest';
import type { Attempt, AttemptList, AttemptMeasure, Status } from '../src/protocol/messages';
import { awaitsJudging, judging } from '../src/state/evaluation';
import { gauge } from '../src/state/gauge';
import { ageMin, Lesson } from '../src/state/lesson.svelte';

const attempt = (id: number, ended_ms = 1000 * id): Attempt => ({
  id,
  number: id,
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
  silence: 'fine',
  measures: [],
  pupil: null,
});
const list = (...attempts: Attempt[]): AttemptList => ({ type: 'attempts', attempts, earlier: 'listed' });
/** The box's list, the oldest first. */
const listed = (...ids: number[]): AttemptList => list(...ids.map((id) => attempt(id)));

describe('attempts', () => {
  it('are listed with the newest first and have the numbers of the box', () => {
    const lesson = new Lesson();
    lesson.take(
      list({ ...attempt(1), number: 51 }, { ...attempt(2), number: null }, { ...attempt(3), number: 52 }),
      null,
    );
    expect(lesson.attempts.map(({ id, number }) => [id, number])).toEqual([
      [3, 52],
      [2, null],
      [1, 51],
    ]);
    expect(lesson.shown?.id).toBe(3);
  });

  it('are those that the box told of last, whatever was known before', () => {
    const lesson = new Lesson();
    expect(lesson.earlier).toBeNull();
    lesson.take(listed(1, 2, 3), null);
    lesson.take({ ...listed(3, 4), earlier: 'recorded' }, null);
    expect(lesson.attempts.map(({ id }) => id)).toEqual([4, 3]);
    lesson.take(listed(), null);
    expect([lesson.attempts, lesson.shown, lesson.earlier]).toEqual([[], null, 'listed']);
  });

  it('are news when they have just ended, once, and by the clock of the box', () => {
    const lesson = new Lesson();
    expect(lesson.take(listed(1), 2000)?.id).toBe(1);
    expect(lesson.take(listed(1), 2000)).toBeNull();
    expect(lesson.take(listed(1, 2), 600_000)).toBeNull();
    expect(lesson.take(listed(1, 2, 3), null)).toBeNull();
    expect(lesson.take(listed(), 3000)).toBeNull();
  });

  it('are no news to a page that has just come, but for one that has just ended', () => {
    expect(new Lesson().take(listed(1, 2, 3), 600_000)).toBeNull();
    expect(new Lesson().take(listed(1, 2, 3), 4000)?.id).toBe(3);
  });

  it('are news for longer where a lesson is played slowly, since all takes longer to be told there', () => {
    // A second of the pupil after its end are ten at a tenth of his speed.
    expect(new Lesson().take(listed(1), 11_000, 0.1)?.id).toBe(1);
    expect(new Lesson().take(listed(2), 12_000, 1)).toBeNull();
    expect(new Lesson().take(listed(3), 12_000, 8)).toBeNull();
  });

  it('that are told of again with another pupil are no news', () => {
    const lesson = new Lesson();
    lesson.take(listed(1, 2), 1000);
    expect(lesson.take(list({ ...attempt(1), pupil: 'B12' }, { ...attempt(2), pupil: '7' }), 1000)).toBeNull();
    expect(lesson.attempts.map(({ pupil }) => pupil)).toEqual(['7', 'B12']);
  });

  it('that are looked at stay so when another one ends, and as long as they are on the list', () => {
    const lesson = new Lesson();
    lesson.take(listed(1), null);
    lesson.show(1);
    lesson.take(listed(1, 2), null);
    expect([lesson.shown?.id, lesson.isNewest]).toEqual([1, false]);
    lesson.reconnect();
    lesson.take(listed(1, 2, 3), null);
    expect([lesson.shown?.id, lesson.isNewest]).toEqual([1, false]);
    lesson.take(listed(2, 3), null);
    expect([lesson.shown?.id, lesson.isNewest]).toEqual([3, true]);
  });

  it('stay known without a connection, and are forgotten with the run of the box that they are of', () => {
    const lesson = new Lesson();
    lesson.take(listed(1, 2), null);
    lesson.reconnect();
    expect(lesson.attempts).toHaveLength(2);
    lesson.forget();
    expect([lesson.attempts, lesson.earlier]).toEqual([[], null]);
  });

  it.each([
    [1000, 0],
    [60_999, 0],
    [61_000, 1],
    [1_900_000, 31],
    [0, 0],
  ])('that ended at one second are at %d ms %d minutes old', (boxMs, minutes) => {
    expect(ageMin(attempt(1), boxMs)).toBe(minutes);
  });

  it('have no age while the clock of the box is not known', () => {
    expect([ageMin(attempt(1), null), ageMin(null, 9e9)]).toEqual([0, 0]);
  });
});

describe('what was asked of the box', () => {
  it('is an activity until the box has confirmed it', () => {
    const lesson = new Lesson();
    expect(lesson.activity.shown('run')).toBe('run');
    lesson.activity.ask('squat', 0);
    expect(lesson.activity.shown('run')).toBe('squat');
    lesson.activity.confirm('run'); // a status that was under way
    expect(lesson.activity.shown('run')).toBe('squat');
    lesson.activity.confirm('squat');
    expect(lesson.activity.shown('run')).toBe('run');
  });

  it('is overdue when its time is over, whatever it was, also if the box says nothing at all', () => {
    const lesson = new Lesson();
    lesson.take(listed(1), null);
    lesson.activity.ask(null, 0);
    lesson.pupil.ask('7', 0);
    lesson.correct(1, '8', 0);
    const states = () => [lesson.activity, lesson.pupil, lesson.owner].map(({ state }) => state);
    lesson.elapse(1000);
    expect(states()).toEqual(['pending', 'pending', 'pending']);
    lesson.elapse(60_000);
    expect(states()).toEqual(['overdue', 'overdue', 'overdue']);
    expect(lesson.activity.shown('run')).toBe('run');
    expect([lesson.corrected?.number, lesson.owner.value]).toEqual([1, '8']);
  });

  it('is an empty list until nothing of what stood on it is told any more, and said if it is told for long', () => {
    const lesson = new Lesson();
    lesson.take(listed(1, 2), null);
    lesson.beginAnew(0);
    lesson.take(listed(1, 2, 3), null); // was under way
    expect(lesson.anew.state).toBe('pending');
    lesson.take(listed(4), null);
    expect(lesson.anew.state).toBe('settled');
    lesson.beginAnew(10_000);
    lesson.take(listed(4), null); // a recording has begun meanwhile, or the connection is away
    lesson.elapse(60_000);
    expect(lesson.anew.state).toBe('overdue');
    lesson.take(listed(), null);
    expect(lesson.anew.state).toBe('settled');
  });

  it('is a correction that is done when the attempt is told of again, and no other', () => {
    const lesson = new Lesson();
    lesson.take(listed(1, 2), null);
    lesson.correct(1, '8', 0);
    lesson.take(list(attempt(1), { ...attempt(2), pupil: '8' }), null);
    expect(lesson.owner.state).toBe('pending');
    lesson.take(list({ ...attempt(1), pupil: '8' }, attempt(2)), null);
    expect(lesson.owner.state).toBe('settled');
  });
});

describe('what judges attempts', () => {
  type Said = Pick<Status, 'processes' | 'evaluation'>;
  const unheard = (state: Said['evaluation']['state']): Said => ({
    processes: [],
    evaluation: { activity: null, activity_chosen_by: null, pupil: null, state },
  });
  const said = (state: Status['processes'][number]['state'], name = 'evaluation'): Said => ({
    ...unheard('unknown'),
    processes: [{ name, state, reason: '', age_s: 0, cpu_cores: 0, rss_mib: 0, restarts: 0 }],
  });

  it('is at work only if the box says so', () => {
    expect([said('ok'), said('degraded')].map(judging)).toEqual(['on', 'on']);
    const away = (['failed', 'silent', 'gone', 'unknown'] as const).map((state) => judging(said(state)));
    expect(away).toEqual(['off', 'off', 'off', 'off']);
    expect(judging(said('ok', 'fusion'))).toBe('off');
  });

  it('is no failure while it gets ready', () => {
    expect([said('starting'), unheard('starting')].map(judging)).toEqual(['starting', 'starting']);
    expect(judging(unheard('unknown'))).toBe('off');
  });

  it('is waited for by a lesson that is played, until the lesson begins without it', () => {
    const played = (position_s: number | null, judge: Said): boolean =>
      awaitsJudging({ ...judge, replay: { title: '7b', began_ms: 0, speed: 1, position_s, length_s: 60 } });
    expect([unheard('starting'), unheard('unknown'), said('ok')].map((judge) => played(0, judge))).toEqual([
      true,
      true,
      false,
    ]);
    expect([played(null, unheard('starting')), played(0.1, unheard('unknown'))]).toEqual([false, false]);
    expect(awaitsJudging({ ...unheard('starting'), replay: null })).toBe(false);
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

  it('is the same line for every attempt, so that two of them can be compared by eye', () => {
    for (const bounds of [{}, { low: null }, { high: null }]) {
      const values = [-20, 40, 55, 85, 95, 300];
      const drawn = values.flatMap((value) => [1, 30].map((sigma) => measure({ ...bounds, value, sigma })!));
      expect(new Set(drawn.map(({ bandFrom }) => bandFrom)).size).toBe(1);
      expect(new Set(drawn.map(({ bandTo }) => bandTo)).size).toBe(1);
      const places = drawn.map(({ at }) => at);
      expect(places).toEqual([...places].sort((a, b) => a - b));
    }
  });

  it('says of a value that is further away than the line is long that it is', () => {
    expect([19, 21, 109, 111].map((value) => measure({ value })!.beyond)).toEqual(['start', null, null, 'end']);
    expect(measure({ value: 111 })!.at).toBe(100);
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
      const { beyond: _, ...places } = measure(change)!;
      for (const place of Object.values(places)) {
        expect(place).toBeGreaterThanOrEqual(0);
        expect(place).toBeLessThanOrEqual(100);
      }
    }
  });
});
