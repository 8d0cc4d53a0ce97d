import { describe, expect, it } from 'vitest';
import { en } from '../src/text/en';

describe('the clock of a lesson', () => {
  it.each([
    [0, '0:00'],
    [59.9, '0:59'],
    [723, '12:03'],
    [3600, '1:00:00'],
    [3725.4, '1:02:05'],
  ])('%d s reads %s', (s, words) => {
    expect(en.formats.clock(s)).toBe(words);
  });

  it('does not claim a time that is not known', () => {
    expect(en.formats.clock(null)).toBe('–');
  });
});

it('two lessons of one day are told apart by the time of day, with and without a title', () => {
  const morning = new Date(2026, 10, 22, 10, 5).getTime();
  expect(en.lesson.replay('7b, throwing')).toBe('Replay · 7b, throwing');
  expect(en.lesson.replay('')).toBe('Replay');
  expect(en.formats.begun(morning)).toMatch(/^22 Nov 2026\D+10:05$/);
});

it('what went wrong in a lesson that is played is not told as if it did so now', () => {
  const { busy, lost, slow } = en.cameras.then;
  for (const words of [busy, lost([2]), lost([1, 2]), slow([2], false), slow([1, 2], false), slow([1, 2], true)]) {
    expect(words).toMatch(/ (was|were) /);
    expect(words).not.toMatch(/ (is|are) /);
  }
});

it('a figure that has just stopped is not said to be missing for 0 seconds', () => {
  expect([null, 0, 1, 2].map(en.staleFor)).toEqual([
    'No new movement',
    'No new movement',
    'No new movement for 1 second',
    'No new movement for 2 seconds',
  ]);
});
