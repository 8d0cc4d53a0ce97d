import type { AttemptMeasure } from '../protocol/messages';

/** Where a value lies beside what is good, in percent of a line. */
export interface Gauge {
  bandFrom: number;
  bandTo: number;
  at: number;
  /** Past which of the line's ends the value lies. */
  beyond: 'start' | 'end' | null;
  doubtFrom: number;
  doubtTo: number;
}

type Bounds = Pick<AttemptMeasure, 'low' | 'high'>;

/**
 * What to draw of a measure; null where there is no value, or nothing to compare it with.
 *
 * The line is as long for every attempt, so that two of them can be compared by eye: what lies beyond it is drawn at its end.
 */
export function gauge({ value, sigma, ...bounds }: Bounds & Pick<AttemptMeasure, 'value' | 'sigma'>): Gauge | null {
  const ends = endsOf(bounds);
  if (value === null || ends === null) return null;
  const { low, high } = bounds;
  const doubt = sigma ?? 0;
  const [start, end] = ends;
  const place = (x: number): number => Math.min(Math.max((100 * (x - start)) / (end - start), 0), 100);
  return {
    bandFrom: low === null ? 0 : place(low),
    bandTo: high === null ? 100 : place(high),
    at: place(value),
    beyond: value < start ? 'start' : value > end ? 'end' : null,
    doubtFrom: place(value - doubt),
    doubtTo: place(value + doubt),
  };
}

/** The line's ends: on either side of what is good as much again; where good goes on for ever, as much as the bound is large. */
function endsOf({ low, high }: Bounds): [number, number] | null {
  const bound = low ?? high;
  if (bound === null) return null;
  const reach = (high ?? bound) - (low ?? bound) || Math.abs(bound) || 1;
  return [(low ?? bound) - reach, (high ?? bound) + reach];
}
