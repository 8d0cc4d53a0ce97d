import { readFileSync } from 'node:fs';
import { describe, expect, it } from 'vitest';
import { de } from '../src/text/de';
import { en } from '../src/text/en';
import { es } from '../src/text/es';
import { unbroken, wholeUnit } from '../src/text/format';
import { spoken } from '../src/text/words.svelte';
import { zh } from '../src/text/zh';

/** Every word, with what leads to it; functions are asked for an example. */
function said(words: unknown, path = ''): [string, string][] {
  if (typeof words === 'string') return [[path, words]];
  if (typeof words !== 'object' || words === null) return [];
  return Object.entries(words).flatMap(([key, value]) => said(value, `${path}.${key}`));
}

describe.each(Object.entries({ de, es, zh }))('the page in %s', (_code, words) => {
  it('says everything that it says in English', () => {
    expect(said(words).map(([path]) => path)).toEqual(said(en).map(([path]) => path));
    const silent = said(words).filter(([, word]) => word === '');
    expect(silent).toEqual(said(en).filter(([, word]) => word === ''));
  });

  it('says hardly anything in English', () => {
    const english = new Map(said(en));
    const same = said(words).filter(([path, word]) => word !== '' && english.get(path) === word);
    const shared = /^(KineBox|MB|Live|Start|Version|Tablets|Details|ok|Details)$/;
    expect(same.filter(([, word]) => !shared.test(word))).toEqual([]);
  });

  it('names every camera that is meant, and how many are left', () => {
    expect(words.cameras.lost([2, 3], 1)).toMatch(/2.*3/);
    expect(words.cameras.givenUp([4])).toContain('4');
    expect(words.cameras.slow([1, 2], false)).toMatch(/1.*2/);
    expect(words.cameras.then.lost([1])).toContain('1');
    expect(words.staleFor(7)).toContain('7');
    expect(words.staleFor(0)).toBe(words.phases.stale.title);
    expect(words.attempts.show(3, 'X', '82', 'B12')).toMatch(/3.*X.*B12.*82/);
    expect(words.attempts.show(3, 'X', null, null)).not.toContain('null');
    for (const say of [words.pupil.is, words.pupil.nextIs, words.pupil.change]) expect(say('B12')).toContain('B12');
    expect(words.feedback.onlyNow('X')).toContain('X');
    expect(words.pupil.correct(4)).toContain('4');
    expect(words.overdue('B12')).toContain('B12');
    expect(words.replay.keyframes).toHaveLength(4);
  });
});

describe('a sentence with codes', () => {
  it('breaks none of them', () => {
    expect(unbroken('Not a code: AB-12 or 7B-12; a well-known one.')).toBe(
      'Not a code: AB\u201112 or 7B\u201112; a well-known one.',
    );
  });
});

describe('numbers', () => {
  it('are written as people of the language do', () => {
    expect(de.formats.number(1234.5, 1)).toBe('1234,5');
    expect(en.formats.number(1234.5, 1)).toBe('1234.5');
    expect(zh.formats.number(null)).toBe('–');
  });

  it('have as many digits as they are sure of', () => {
    expect(en.formats.estimate(24.31, 4.2, 'deg')).toEqual({ value: '24', sigma: '4', unit: '°', of: '' });
    expect(en.formats.estimate(1.234, 0.2, 'm_s')).toEqual({ value: '1.2', sigma: '0.2', unit: ' m/s', of: '' });
    expect(de.formats.estimate(0.4812, 0.03, 's')).toEqual({ value: '0,48', sigma: '0,03', unit: ' s', of: '' });
  });

  it('are written as on paper', () => {
    // `tests/unit/test_report_page.py` reads the same table.
    const table = new URL('../../../../tests/golden/numbers/estimates.json', import.meta.url);
    const cases = JSON.parse(readFileSync(table, 'utf-8')) as {
      value: number;
      sigma: number;
      unit: string;
      text: string;
    }[];
    const written = cases.map((each) => {
      const { value, sigma, unit } = en.formats.estimate(each.value, each.sigma, each.unit);
      return `${value} ± ${sigma}${unit}`;
    });
    expect(written).toEqual(cases.map(({ text }) => text));
  });

  it('say of a percentage what it is of', () => {
    const units = [en, de, es, zh].map(({ formats }) => wholeUnit(formats.estimate(12, 3, 'pct')));
    expect(units).toEqual([' % of height', ' % der Größe', ' % de estatura', ' % 身高']);
    expect(wholeUnit(en.formats.estimate(12, 3, 'deg'))).toBe('°');
  });

  it('say how long ago something was', () => {
    expect([en, de, es].map(({ formats }) => formats.ago(12))).toEqual([
      '12 minutes ago',
      'vor 12 Minuten',
      'hace 12 minutos',
    ]);
    expect(zh.formats.ago(12)).toMatch(/^12\s?分钟前$/);
    expect([1, 59, 60, 119, 180].map(en.formats.ago)).toEqual([
      '1 minute ago',
      '59 minutes ago',
      '1 hour ago',
      '1 hour ago',
      '3 hours ago',
    ]);
  });

  it('keep a unit that this page does not know', () => {
    expect(en.formats.estimate(3, 1, 'furlong').unit).toBe(' furlong');
    expect(en.formats.estimate(3, 1, '').unit).toBe('');
  });
});

describe('the language', () => {
  it('is the first of those wished for that the page speaks', () => {
    expect(spoken(['de-AT', 'en'])).toBe('de');
    expect(spoken(['fr', 'zh-Hant-TW'])).toBe('zh');
    expect(spoken(['fr-FR'])).toBeNull();
    expect(spoken([])).toBeNull();
  });
});
