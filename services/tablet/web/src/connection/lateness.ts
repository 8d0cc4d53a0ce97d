import type { Status } from '../protocol/messages';
import { boxIsBusy } from '../state/cameras';

/** Who is to blame that pictures come too late. `unknown`: it cannot be told from here. */
export type LateCause = 'box' | 'tablet' | 'network' | 'unknown';

/** A box with less of its processor free than this lets everything wait, the way to the tablet too. */
const BUSY_SHARE = 0.9;
/** A figure that is so old when the server packs it was late before it was sent. Undisturbed it is 0.1 to 0.3 s. */
const LATE_AT_SERVER_MS = 500;
/** A page whose turn comes so much too late lets what has arrived lie. */
const HELD_UP_MS = 150;
/** So long a verdict holds: load comes and goes faster than anybody reads. */
const HOLDS_MS = 5000;

type Load = Pick<Status, 'cameras' | 'cpu_load' | 'latency' | 'machine' | 'replay'>;

/** The box has too much to do, by its own figures. */
export function boxIsLate(status: Load): boolean {
  const { cameras, cpu_load: load, latency, machine, replay } = status;
  const used = (machine?.used_cores ?? 0) / (machine?.granted_cores ?? Infinity);
  if (Math.max(load ?? 0, used) >= BUSY_SHARE) return true;
  // Of a lesson that is played, cameras and age are those of then.
  return replay === null && (boxIsBusy(cameras) || (latency?.p50_ms ?? 0) > LATE_AT_SERVER_MS);
}

/**
 * Finds out who is to blame, the likeliest first: the box, then this tablet. The network is what remains, and only where there
 * is one between the box and this page.
 */
export class Lateness {
  private boxLateMs = -Infinity;
  private heldUpMs = -Infinity;
  private heard = false;

  /** @param distant the page does not run on the box itself */
  constructor(private readonly distant: boolean) {}

  noteStatus(status: Load, nowMs: number): void {
    this.heard = true;
    if (boxIsLate(status)) this.boxLateMs = nowMs;
  }

  /** A turn of this page that was due came `lateMs` too late. */
  noteTurn(lateMs: number, nowMs: number): void {
    if (lateMs > HELD_UP_MS) this.heldUpMs = nowMs;
  }

  reset(): void {
    this.boxLateMs = this.heldUpMs = -Infinity;
    this.heard = false;
  }

  cause(nowMs: number): LateCause {
    if (nowMs - this.boxLateMs < HOLDS_MS) return 'box';
    if (nowMs - this.heldUpMs < HOLDS_MS) return 'tablet';
    return this.heard && this.distant ? 'network' : 'unknown';
  }
}

/** Whether the page of that host comes over a network. */
export function isDistant(hostname: string): boolean {
  return !(hostname === 'localhost' || hostname === '[::1]' || hostname.startsWith('127.'));
}
