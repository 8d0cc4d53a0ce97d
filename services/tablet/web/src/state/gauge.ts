import type { AttemptMeasure } from '../protocol/messages';

/** Where a value lies beside what is good, in percent of a line. */
export interface Gauge {
  bandFrom: number;
  bandTo: number;
  at: number;
  doubtFrom: number;
  doubtTo: number;
}

/** So much of the line lies on either side of what is to be seen. */
const MARGIN = 0.12;

/** What to draw of a measure; null where there is no value, or nothing to compare it with. */
export function gauge({
  value,
  sigma,
  low,
  high,
}: Pick<AttemptMeasure, 'value' | 'sigma' | 'low' | 'high'>): Gauge | null {
  if (value === null || (low === null && high === null)) return null;
  const doubt = sigma ?? 0;
  const bound = low ?? high!;
  // Where good goes on for ever, the line shows as much of it as lies between the value and the bound, and a little.
  const reach = Math.max(Math.abs(value - bound), 3 * doubt, 0.1 * Math.abs(bound), 1e-9);
  const [first, last] = [low ?? high! - reach, high ?? low! + reach];
  const [from, to] = [Math.min(first, value - doubt), Math.max(last, value + doubt)];
  const spare = MARGIN * (to - from || 1);
  const start = from - (low === null && first === from ? 0 : spare);
  const end = to + (high === null && last === to ? 0 : spare);
  const place = (x: number): number => Math.min(Math.max((100 * (x - start)) / (end - start), 0), 100);
  return {
    bandFrom: low === null ? 0 : place(low),
    bandTo: high === null ? 100 : place(high),
    at: place(value),
    doubtFrom: place(value - doubt),
    doubtTo: place(value + doubt),
  };
}
