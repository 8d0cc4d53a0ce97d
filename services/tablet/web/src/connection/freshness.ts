import type { MotionFrame } from '../protocol/motionFrame';

/**
 * A figure older than this is grey: it has stood still for longer than a healthy box ever lets it, a busy one hardly ever. Nothing
 * is said yet, for most halts are over before anybody has read what would be.
 */
export const HALTED_AFTER_MS = 500;
/** Motion older than this is no longer called live. */
export const STALE_AFTER_MS = 1500;
/** A frame that was under way for longer is not drawn: it shows a past that the tablet has already missed. */
export const TOO_LATE_MS = 300;

/**
 * How old what is on the screen is. Frames that only repeat an old observation do not count as new, so a fusion that carries
 * on without cameras becomes stale as it should.
 */
export class Freshness {
  private newestNs: bigint | null = null;
  private exposedMs = -Infinity;

  /** A frame arrived at local time `nowMs`. */
  note(frame: MotionFrame, nowMs: number): void {
    if (frame.tNewestNs === this.newestNs) return;
    this.newestNs = frame.tNewestNs;
    this.exposedMs = nowMs - frame.serverLatencyUs / 1000;
  }

  reset(): void {
    this.newestNs = null;
    this.exposedMs = -Infinity;
  }

  /** Milliseconds since the exposure of the newest picture that is part of the figure; infinite if there is none. */
  ageMs(nowMs: number): number {
    return nowMs - this.exposedMs;
  }

  isHalted(nowMs: number): boolean {
    return this.ageMs(nowMs) > HALTED_AFTER_MS;
  }

  isStale(nowMs: number): boolean {
    return this.ageMs(nowMs) > STALE_AFTER_MS;
  }
}

/** Milliseconds since the server packed the frame, or null while the box's clock is not known. */
export function underWayMs(frame: MotionFrame, boxNowMs: number | null): number | null {
  if (boxNowMs === null) return null;
  return boxNowMs - Number(frame.tNewestNs / 1000n) / 1000 - frame.serverLatencyUs / 1000;
}

/** Milliseconds since the instant that the figure shows, or, where it is foretold, since the newest picture that it rests on. */
export function figureAgeMs(frame: MotionFrame, boxNowMs: number): number {
  const shownNs = frame.tNs < frame.tNewestNs ? frame.tNs : frame.tNewestNs;
  return boxNowMs - Number(shownNs / 1000n) / 1000;
}
