/** What the words around a replay are made of. Where exactly it is, frame by frame, stays outside of the reactive state. */

import type { Speed } from './player';
import type { StandardShown } from './scene';

/** `missing`: the box has it no more; `failed`: it did not arrive, and may be asked for again. */
export type ReplayPhase = 'off' | 'loading' | 'shown' | 'missing' | 'failed';

export class ReplayShow {
  phase = $state<ReplayPhase>('off');
  /** Of the attempt. */
  id = $state<number | null>(null);
  playing = $state(true);
  lengthS = $state(0);
  keyframesS = $state.raw<readonly number[]>([]);
  /** Frame by frame how far from the standard, 0 to 1. */
  amiss = $state.raw<readonly number[]>([]);
  hasStandard = $state(true);
  /** Attempts that can be seen without a connection. */
  kept = $state.raw<ReadonlySet<number>>(new Set());

  // What was chosen holds for the next replays too.
  speed = $state<Speed>(0.5);
  standard = $state<StandardShown>('ghost');
  mirror = $state(false);

  on = $derived(this.phase !== 'off');
}
