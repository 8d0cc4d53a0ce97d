import { describe, expect, it } from 'vitest';
import { de } from '../src/text/de';
import { en } from '../src/text/en';
import { es } from '../src/text/es';
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
    expect(words.attempts.show(3, 'X', '82')).toMatch(/3.*X.*82/);
    expect(words.replay.keyframes).toHaveLength(4);
  });
});

describe('numbers', () => {
  it('are written as people of the language do', () => {
    expect(de.formats.number(1234.5, 1)).toBe('1234,5');
    expect(en.formats.number(1234.5, 1)).toBe('1234.5');
    expect(zh.formats.number(null)).toBe('–');
  });

  it('have as many digits as they are sure of', () => {
    expect(en.formats.estimate(24.31, 4.2, 'deg')).toEqual({ value: '24', sigma: '4', unit: '°' });
    expect(en.formats.estimate(1.234, 0.2, 'm_s')).toEqual({ value: '1.2', sigma: '0.2', unit: ' m/s' });
    expect(de.formats.estimate(0.4812, 0.03, 's')).toEqual({ value: '0,48', sigma: '0,03', unit: ' s' });
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
