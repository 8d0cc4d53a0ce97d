/** What is known of the attempts of this lesson, for the words on the page. */

import type { Attempt, AttemptList, Teaching } from '../protocol/messages';
import { Wish } from './wish.svelte';

/** Of the pupil's time; what ended longer ago is news no more: the page was opened, or the connection came back, after it. */
const NEWS_MS = 8000;
const MINUTE_MS = 60_000;
/** An attempt that is older may be of another pupil's lesson, and is shown as past. */
export const OLD_MIN = 3;

/** Whole minutes since an attempt ended, by the box's clock; 0 while that is not known. */
export function ageMin(attempt: Attempt | null, boxMs: number | null): number {
  return attempt === null || boxMs === null ? 0 : Math.max(Math.floor((boxMs - attempt.ended_ms) / MINUTE_MS), 0);
}

export class Lesson {
  /** What is said about attempts; null until the box has told. */
  teaching = $state.raw<Teaching | null>(null);
  /** The newest first. */
  attempts = $state.raw<readonly Attempt[]>([]);
  /** What became of attempts from before the box's server was started again; null until the box has told. */
  earlier = $state<AttemptList['earlier'] | null>(null);
  /** The attempt that the words are about, if it is not the newest. */
  private chosenId = $state<number | null>(null);
  shown = $derived(this.attempts.find(({ id }) => id === this.chosenId) ?? this.attempts[0] ?? null);
  isNewest = $derived(this.shown === (this.attempts[0] ?? null));

  /** An action; null is whatever the box recognises. */
  readonly activity = new Wish();
  /** Who is up; null is nobody who is named. */
  readonly pupil = new Wish();
  /** Whose `corrected` was after all; null is nobody who is named. */
  readonly owner = new Wish();
  corrected = $state.raw<Attempt | null>(null);
  /** That nothing of what stood on the list stands there any more: always null. */
  readonly anew = new Wish();
  /** The newest attempt as that was asked for. */
  private stoodId: number | null = null;

  /**
   * The box told of all attempts on its list. They are shown at once, in the place of those before.
   *
   * @param boxMs the box's clock now, null while it is not known
   * @param speed seconds of the pupil a second; less than 1 in a lesson that is played slowly, where all takes longer to be told
   * @returns the attempt that has just ended, if the newest is one, and was not told of before
   */
  take(list: AttemptList, boxMs: number | null, speed = 1): Attempt | null {
    const known = new Set(this.attempts.map(({ id }) => id));
    this.attempts = [...list.attempts].reverse();
    this.earlier = list.earlier;
    if (this.attempts.every(({ id }) => id !== this.chosenId)) this.chosenId = null;
    const corrected = this.attempts.find(({ id }) => id === this.corrected?.id);
    if (corrected !== undefined) this.owner.confirm(corrected.pupil);
    if (this.attempts.every(({ id }) => id !== this.stoodId)) this.anew.confirm(null);
    const newest = this.attempts[0];
    if (newest === undefined || known.has(newest.id) || boxMs === null) return null;
    return boxMs - newest.ended_ms < NEWS_MS / Math.min(speed, 1) ? newest : null;
  }

  /** The words are about this attempt from now on; about the newest with null. */
  show(id: number | null): void {
    this.chosenId = id;
  }

  /** An attempt is to be given to another pupil. */
  correct(attempt: number, pupil: string | null, nowMs: number): void {
    if (attempt !== this.corrected?.id) this.owner.reconnect(); // what was said of another one is no news of this
    this.corrected = this.attempts.find(({ id }) => id === attempt) ?? null;
    this.owner.ask(pupil, nowMs);
  }

  /** The list is to begin anew. */
  beginAnew(nowMs: number): void {
    this.stoodId = this.attempts[0]?.id ?? null;
    this.anew.ask(null, nowMs);
  }

  /** Time went by. */
  elapse(nowMs: number): void {
    for (const wish of this.wishes) wish.elapse(nowMs);
  }

  /** Another connection. What is known of attempts stays until the box has told anew. */
  reconnect(): void {
    for (const wish of this.wishes) wish.reconnect();
  }

  /** Another run of the box: its attempts are others. */
  forget(): void {
    this.attempts = [];
    this.earlier = null;
    this.chosenId = null;
    this.corrected = null;
  }

  private get wishes(): Wish[] {
    return [this.activity, this.pupil, this.owner, this.anew];
  }
}
