import type { LateCause } from '../connection/lateness';
import type { Phase } from '../connection/phase';
import type { Status } from '../protocol/messages';
import { boxIsBusy } from './cameras';

/** What the words on the page are made of. Changes a few times a second; poses never come through here. */
export class Room {
  phase = $state<Phase>('connecting');
  status = $state.raw<Status | null>(null);
  /** Who is to blame where pictures come too late. */
  lateCause = $state<LateCause>('unknown');
  /** A lesson is played: nothing is live, and the cameras' states are those of then. */
  replaying = $derived(this.status?.replay != null);
  /** The page says once that the box is busy, in the place of the same words on every camera. */
  busy = $derived(this.phase === 'live' && boxIsBusy(this.status?.cameras ?? []));
  /** Age of the figure on the screen, in whole seconds; null while there is none. */
  figureAgeS = $state<number | null>(null);
  /** From the shutter to this screen; null while it cannot be known. */
  delayMs = $state<number | null>(null);
  roundTripMs = $state<number | null>(null);
  /** The box's clock, as of a second ago at most; null while it is not known. It goes on without a connection. */
  boxMs = $state<number | null>(null);
  /** Pictures of the figure drawn in the last second. */
  drawnHz = $state(0);
  droppedLate = $state(0);
  unreadable = $state(0);
}
