/** Numbers and times as people of a language write them. */

export interface Formats {
  number: (value: number | null, digits?: number) => string;
  clock: (s: number | null) => string;
  /** Day and time of day, by which two lessons of one day are told apart. */
  begun: (ms: number) => string;
  moment: (ms: number | null) => string;
  milliseconds: (ms: number | null) => string;
  ms: (value: number | null) => string;
  pair: (a: number | null, b: number | null, digits?: number) => string;
  percent: (share: number | null) => string;
  degrees: (celsius: number | null) => string;
  /** Memory in MB, of an amount in MiB. */
  megabytes: (mib: number | null) => string;
  /** An amount in MiB with its unit, a decimal one as everywhere else that people read. */
  size: (mib: number | null) => string;
  /** How fast something is played. */
  pace: (factor: number) => string;
  /** So many minutes ago; from an hour on in hours. */
  ago: (minutes: number) => string;
  estimate: (value: number, sigma: number, unit: string) => Estimate;
}

/** A measured value in words: the number, how far it may be off, its unit, and what that is of, where it does not say so itself. */
export interface Estimate {
  value: string;
  sigma: string;
  unit: string;
  of: string;
}

/** In the place of what is not known. */
export const NONE = '–';
const MB_OF_MIB = 2 ** 20 / 1e6;
const MINUS = '\u2212';
/** Of measures, as they stand behind a number. */
const UNITS: Record<string, string> = { deg: '°', cm: ' cm', pct: ' %', m_s: ' m/s', s: ' s', deg_s: ' °/s' };

/**
 * @param locale as browsers know it
 * @param ofHeight what a percentage of the pupil's height is of
 */
export function formats(locale: string, ofHeight: string): Formats {
  const begins = new Intl.DateTimeFormat(locale, { dateStyle: 'medium', timeStyle: 'short' });
  const moments = new Intl.DateTimeFormat(locale, { dateStyle: 'medium', timeStyle: 'medium' });
  const ages = new Intl.RelativeTimeFormat(locale);
  const known = (value: number, digits: number): string =>
    // Rounded first: what becomes nought has no minus. (`signDisplay: 'negative'` is not known to Chrome 100.)
    (Number(value.toFixed(digits)) + 0)
      .toLocaleString(locale, { minimumFractionDigits: digits, maximumFractionDigits: digits, useGrouping: false })
      .replace('-', MINUS);
  const number = (value: number | null, digits = 0): string => (value === null ? NONE : known(value, digits));
  return {
    number,
    clock,
    begun: (ms) => begins.format(ms),
    moment: (ms) => (ms === null ? NONE : moments.format(ms)),
    milliseconds: (ms) => (ms === null ? NONE : `${Math.round(ms / 10) * 10} ms`),
    ms: (value) => (value === null ? NONE : `${known(value, 0)} ms`),
    pair: (a, b, digits = 0) => `${number(a, digits)} / ${number(b, digits)}`,
    percent: (share) => (share === null ? NONE : `${known(100 * share, 0)} %`),
    degrees: (celsius) => (celsius === null ? NONE : `${known(celsius, 0)} °C`),
    megabytes: (mib) => number(mib === null ? null : mib * MB_OF_MIB),
    size: (mib) => {
      if (mib === null) return NONE;
      const mb = mib * MB_OF_MIB;
      return mb < 999.5 ? `${known(mb, 0)} MB` : `${known(mb / 1000, 1)} GB`;
    },
    pace: (factor) => `${{ 0.25: '¼', 0.5: '½' }[factor] ?? factor.toLocaleString(locale)}×`,
    ago: (minutes) => (minutes < 60 ? ages.format(-minutes, 'minute') : ages.format(-Math.floor(minutes / 60), 'hour')),
    estimate: (value, sigma, unit) => {
      const digits = digitsOf(sigma);
      return {
        value: known(value, digits),
        sigma: known(sigma, digits),
        unit: UNITS[unit] ?? (unit && ` ${unit}`),
        of: unit === 'pct' ? ofHeight : '',
      };
    },
  };
}

/** A sentence with codes in it, none of which is broken at its hyphen. */
export function unbroken(sentence: string): string {
  return sentence.replace(/-(?=[0-9])/g, '\u2011');
}

/** Minutes and seconds, with hours where there are any; the same in all languages. */
function clock(s: number | null): string {
  if (s === null) return NONE;
  const whole = Math.floor(s);
  const minutes = Math.floor(whole / 60) % 60;
  const hours = Math.floor(whole / 3600);
  const parts = hours > 0 ? [hours, String(minutes).padStart(2, '0')] : [minutes];
  return [...parts, String(whole % 60).padStart(2, '0')].join(':');
}

/** Digits that say something: one of the uncertainty, at most two after the point. */
function digitsOf(sigma: number): number {
  if (sigma >= 0.95) return 0;
  return sigma >= 0.095 ? 1 : 2;
}

/** The unit with what it is of: " % of height". */
export function wholeUnit({ unit, of }: Estimate): string {
  return of === '' ? unit : `${unit} ${of}`;
}
