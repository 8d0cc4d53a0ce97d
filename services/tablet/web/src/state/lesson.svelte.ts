/** What is known of the attempts of this lesson, for the words on the page. */

import type { Attempt, Teaching } from '../protocol/messages';

/** As many as the box remembers. */
const KEPT = 50;
/** An attempt that ended longer ago is news no more: the page was opened, or the connection came back, after it. */
const NEWS_MS = 8000;
/** So long a choice is shown before the box has confirmed it. */
const PENDING_MS = 4000;

/** An attempt and its place in the lesson, counted from 1. */
export interface Listed {
  number: number;
  attempt: Attempt;
}

export class Lesson {
  /** What is said about attempts; null until the box has told. */
  teaching = $state.raw<Teaching | null>(null);
  /** The newest first. */
  attempts = $state.raw<readonly Listed[]>([]);
  /** The attempt that the words are about, if it is not the newest. */
  private chosenId = $state<number | null>(null);
  shown = $derived(this.attempts.find(({ attempt }) => attempt.id === this.chosenId) ?? this.attempts[0] ?? null);
  isNewest = $derived(this.shown === (this.attempts[0] ?? null));

  /** What was asked for and the box has not confirmed: an action, "" for any, null if nothing was. */
  private pending = $state<string | null>(null);
  private pendingUntilMs = -Infinity;

  /** An attempt was told of; true if it has just ended. `boxMs` is the box's clock now, null while it is not known. */
  note(attempt: Attempt, boxMs: number | null): boolean {
    if (this.attempts.some((listed) => listed.attempt.id === attempt.id)) return false;
    const number = (this.attempts[0]?.number ?? 0) + 1;
    this.attempts = [{ number, attempt }, ...this.attempts].slice(0, KEPT);
    return boxMs !== null && boxMs - attempt.ended_ms < NEWS_MS;
  }

  /** The words are about this attempt from now on; about the newest with null. */
  show(id: number | null): void {
    this.chosenId = id;
  }

  /** Another connection: the box tells anew what there was. */
  forget(): void {
    this.attempts = [];
    this.chosenId = null;
    this.pending = null;
  }

  ask(activity: string | null, nowMs: number): void {
    this.pending = activity ?? '';
    this.pendingUntilMs = nowMs + PENDING_MS;
  }

  /** The box said which activity it expects. */
  confirm(activity: string | null, nowMs: number): void {
    if (this.pending === (activity ?? '') || nowMs > this.pendingUntilMs) this.pending = null;
  }

  /** The activity to show, where the box says this one: what was asked for goes first, for a moment. */
  activity(ofBox: string | null): string | null {
    return this.pending === null ? ofBox : this.pending || null;
  }
}
