const SHORTEST_MS = 250;
const LONGEST_MS = 5000;

/**
 * How long to wait before trying again: doubles from 250 ms to 5 s, each time between half of it and all of it, so that the
 * tablets of a school do not all come back in the same instant.
 *
 * @param failures attempts that failed since the last connection that worked
 * @param random a number in [0, 1)
 */
export function reconnectDelayMs(failures: number, random: number): number {
  const longest = Math.min(LONGEST_MS, SHORTEST_MS * 2 ** failures);
  const shortest = Math.max(SHORTEST_MS, longest / 2);
  return shortest + (longest - shortest) * random;
}
