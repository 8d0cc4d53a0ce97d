/** So long the box has for what was asked of it. */
export const PATIENCE_MS = 4000;
/** So long it is said that the box has not done it yet. */
export const TOLD_MS = 20_000;

/**
 * Something that was asked of the box: shown at once, as the wish that it is. If the box does not do it in time, that is said, and
 * what the box says is shown again. It may still be done: the box keeps what it has heard for a part of it that is started again.
 * Null is a value, too.
 */
export class Wish {
  state = $state<'settled' | 'pending' | 'overdue'>('settled');
  /** What was asked for last. */
  value = $state.raw<string | null>(null);
  private untilMs = Infinity;
  /** All that was asked for since this page and the box agreed. */
  private asked: (string | null)[] = [];
  /** What the box said last; undefined before it did. */
  private ofBox: string | null | undefined;

  ask(value: string | null, nowMs: number): void {
    this.asked = this.state === 'pending' ? [...this.asked, value] : [value];
    this.value = value;
    this.state = 'pending';
    this.untilMs = nowMs + PATIENCE_MS;
  }

  /** The box said what is so. Its news count, whatever was asked for: another tablet may have asked since. */
  confirm(value: string | null): void {
    const news = this.ofBox !== undefined && this.ofBox !== value;
    this.ofBox = value;
    // Of two touches in a row the box does the first one first: that is no news.
    if (value === this.value || (news && !this.asked.includes(value))) this.state = 'settled';
  }

  /** Time went by, whether the box has said anything or not. */
  elapse(nowMs: number): void {
    if (this.state === 'settled' || nowMs <= this.untilMs) return;
    this.state = this.state === 'pending' ? 'overdue' : 'settled';
    this.untilMs = nowMs + TOLD_MS;
  }

  /** What to show where the box says this: what was asked for goes first, for a moment. */
  shown(ofBox: string | null): string | null {
    return this.state === 'pending' ? this.value : ofBox;
  }

  /** Another connection: whether the box has heard what was asked for, its first words will tell. */
  reconnect(): void {
    this.ofBox = undefined;
  }
}
