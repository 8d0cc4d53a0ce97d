import { readFileSync } from 'node:fs';
import { describe, expect, it } from 'vitest';
import { codeAfter, codeOf, NUMBERS } from '../src/state/pupils';

interface Case {
  typed: string;
  code: string | null;
  next?: string | null;
}

// `tests/unit/test_pupil_codes.py` reads the same table.
const TABLE = new URL('../../../../tests/golden/pupil_codes/codes.json', import.meta.url);
const CASES = JSON.parse(readFileSync(TABLE, 'utf-8')) as Case[];
const CODES = CASES.filter((each): each is Case & { code: string } => each.code !== null);

describe('a code', () => {
  it.each(CASES)('is read from "$typed": $code', ({ typed, code }) => {
    expect(codeOf(typed)).toBe(code);
  });

  it('is what the box takes for one', () => {
    const description = readFileSync(new URL('../openapi.json', import.meta.url), 'utf-8');
    const { pupil } = JSON.parse(description).components.schemas.Turn.properties;
    const { pattern, maxLength } = pupil.anyOf.find(({ type }: { type: string }) => type === 'string');
    const taken = (code: string): boolean => new RegExp(pattern).test(code) && code.length <= maxLength;
    expect(CODES.filter(({ code }) => !taken(code))).toEqual([]);
    expect(CASES.filter(({ typed, code }) => typed !== code && taken(typed))).toEqual([]);
  });

  it('has a key of its own from 1 to 36', () => {
    expect([NUMBERS.length, NUMBERS[0], NUMBERS.at(-1)]).toEqual([36, '1', '36']);
    expect(NUMBERS.map(codeOf)).toEqual(NUMBERS);
  });
});

describe('the next code', () => {
  it.each(CODES)('after $code is $next', ({ code, next }) => {
    expect(codeAfter(code)).toBe(next);
  });

  it.each([
    ['7-2', null],
    ['EMMA2', null],
    ['P-07', 'P-08'],
    ['09', '10'],
  ])('after %s, which a lesson may hold, is %s', (code, next) => {
    expect(codeAfter(code)).toBe(next);
  });
});
