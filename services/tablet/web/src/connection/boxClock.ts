const SAMPLES = 15;

/**
 * The box's clock as seen from here. A tablet's own clock is wrong by minutes, so nothing is ever compared with it: the
 * difference between the two monotonic clocks is measured by ping, and the quickest of the last answers is believed, because
 * its way there and back leaves the least room for error (at most half of its round trip).
 */
export class BoxClock {
  private samples: { roundTripMs: number; offsetMs: number }[] = [];

  /** A ping sent at `sentMs` was answered at box time `boxMs` and the answer arrived at `receivedMs`. */
  addPong(sentMs: number, boxMs: number, receivedMs: number): void {
    const roundTripMs = receivedMs - sentMs;
    this.samples.push({ roundTripMs, offsetMs: boxMs - (sentMs + roundTripMs / 2) });
    if (this.samples.length > SAMPLES) this.samples.shift();
  }

  /** Another connection may lead to another box. */
  reset(): void {
    this.samples = [];
  }

  /** The newest round trip; null before the first answer. */
  get roundTripMs(): number | null {
    return this.samples.at(-1)?.roundTripMs ?? null;
  }

  /** Box time in milliseconds at the local time; null before the first answer. */
  boxMs(localMs: number): number | null {
    if (this.samples.length === 0) return null;
    const best = this.samples.reduce((a, b) => (b.roundTripMs < a.roundTripMs ? b : a));
    return localMs + best.offsetMs;
  }
}
