import { describe, expect, it } from 'vitest';
import { troubleForTeacher } from '../src/state/machine';
import { en } from '../src/text/en';

describe('troubles of the machine', () => {
  it('reach the teacher when the lesson suffers, the worst first', () => {
    expect(troubleForTeacher(['disk_full', 'hot'])).toBe('disk_full');
    expect(troubleForTeacher(['clock_set', 'hot'])).toBe('hot');
  });

  it('stay with the technician otherwise', () => {
    expect(troubleForTeacher([])).toBeNull();
    expect(troubleForTeacher(['disk_low', 'clock_set'])).toBeNull();
  });
});

describe('sizes', () => {
  it('are in the unit that people use', () => {
    expect(en.formats.size(null)).toBe('–');
    expect(en.formats.size(812)).toBe('812 MB');
    expect(en.formats.size(1536)).toBe('1.5 GB');
  });
});
