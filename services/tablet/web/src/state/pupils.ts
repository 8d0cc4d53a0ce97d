/** Codes of pupils: what is one, as the box sees it, and which one comes next. No name is one; `models/messages/pupil.py` says why. */

const CODE = /^(?:0|[1-9][0-9]*|[0-9]+[A-Z]|[A-Z]-?[0-9]+|[A-Z]{2}-[0-9]{2,}|[0-9]+[A-DF-Z]-[0-9]+)$/i;
const LONGEST = 8;

/** One touch each; most classes are smaller. */
export const NUMBERS: readonly string[] = Array.from({ length: 36 }, (_, index) => String(index + 1));

/** A code as somebody types it, also in small letters, or with zeros before a number; null if it is none. */
export function codeOf(typed: string): string | null {
  const code = typed.trim().replace(/^0+(?=[0-9]+$)/, '');
  return code.length <= LONGEST && CODE.test(code) ? code.toUpperCase() : null;
}

/** The code after this one: 8 after 7, B13 after B12, P10 after P09; null after one that does not end with a number. */
export function codeAfter(code: string): string | null {
  const [, before = '', number] = /^(.*?)([0-9]+)$/.exec(code) ?? [];
  if (number === undefined) return null;
  return codeOf(before + String(Number(number) + 1).padStart(number.length, '0'));
}
