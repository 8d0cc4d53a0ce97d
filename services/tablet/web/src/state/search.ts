/** When the page may say that nobody is there. */

import type { Status } from '../protocol/messages';

/** So long must the box have looked in vain: whoever is there is found within this time, also after a restart. */
export const LOOKED_FOR_MS = 3000;
/** A figure needs two cameras, and so does the absence of one. */
const NEEDED = 2;

type Look = Pick<Status, 'cameras' | 'pupil'>;

export class Search {
  private sinceMs: number | null = null;

  note(status: Look, nowMs: number): void {
    if (!searches(status)) this.sinceMs = null;
    else this.sinceMs ??= nowMs;
  }

  reset(): void {
    this.sinceMs = null;
  }

  /** The box has looked for a pupil with enough cameras, for long enough, and found none. */
  inVain(nowMs: number): boolean {
    return this.sinceMs !== null && nowMs - this.sinceMs >= LOOKED_FOR_MS;
  }
}

function searches(status: Look): boolean {
  const looking = status.cameras.filter(
    (camera) => (camera.state === 'ok' || camera.state === 'slow') && (camera.fresh_hz ?? 0) > 0,
  );
  return status.pupil === 'searching' && looking.length >= NEEDED;
}
