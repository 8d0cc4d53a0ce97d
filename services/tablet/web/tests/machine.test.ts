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
  it('are in the decimal unit that people use, although messages count in MiB', () => {
    expect(en.formats.size(null)).toBe('–');
    expect(en.formats.size(812)).toBe('851 MB');
    expect(en.formats.size(953.6)).toBe('1.0 GB');
    expect(en.formats.size(1536)).toBe('1.6 GB');
    expect(en.formats.megabytes(100)).toBe('105');
    expect(en.formats.megabytes(null)).toBe('–');
  });
});
