import { describe, expect, it } from 'vitest';
import { PaceWatch, wishedQuality } from '../src/stage/quality';

describe('drawing', () => {
  it('is as the address asks, and otherwise as the tablet can', () => {
    expect(wishedQuality('http://box:8080/?drawing=full')).toBe('full');
    expect(wishedQuality('http://box:8080/?drawing=light')).toBe('light');
    expect(wishedQuality('http://box:8080/?drawing=pretty')).toBeNull();
    expect(wishedQuality('http://box:8080/')).toBeNull();
  });

  it('stays as it is at the pace of the screen', () => {
    const pace = new PaceWatch();
    for (let picture = 0; picture < 1000; picture++) expect(pace.tooSlow(16.7)).toBe(false);
  });

  it('becomes light when pictures keep being waited for, and not for one hiccup or a hidden page', () => {
    const pace = new PaceWatch();
    for (let picture = 0; picture < 100; picture++) expect(pace.tooSlow(picture === 50 ? 400 : 10)).toBe(false);
    expect(pace.tooSlow(600_000)).toBe(false);
    const slow = Array.from({ length: 100 }, () => pace.tooSlow(90));
    expect(slow.at(-1)).toBe(true);
  });
});
