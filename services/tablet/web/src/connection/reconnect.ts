const SHORTEST_MS = 250;
const LONGEST_MS = 5000;
/** Whoever is killed is back within two seconds; until then every half second counts. */
const EAGER_TRIES = 8;
const EAGER_MS = 500;

/**
 * How long to wait before trying again: at first half a second at most, then doubling up to 5 s, each time between half of it and
 * all of it, so that the tablets of a school do not all come back in the same instant.
 *
 * @param failures attempts that failed since the last connection that worked
 * @param random a number in [0, 1)
 */
export function reconnectDelayMs(failures: number, random: number): number {
  const doublings = Math.max(failures + 1 - EAGER_TRIES, 0);
  const longest = failures === 0 ? SHORTEST_MS : Math.min(LONGEST_MS, EAGER_MS * 2 ** doublings);
  const shortest = Math.max(SHORTEST_MS, longest / 2);
  return shortest + (longest - shortest) * random;
}
