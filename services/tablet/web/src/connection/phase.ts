import type { Status } from '../protocol/messages';

/** What the page may claim about the figure. Only `live` is coloured. */
export type Phase =
  | 'connecting' // no connection yet
  | 'offline' // the connection is gone
  | 'ended' // so is what was played, and that was its end
  | 'failed' // what makes the figure failed for good
  | 'searching' // connected; no figure yet, and whether there is a pupil is not known
  | 'waiting' // connected; nobody is there
  | 'stale' // a figure is there, and it is old
  | 'late' // frames come, and all of them too late
  | 'unable' // this browser draws nothing in 3D
  | 'live';

/** How what makes the figure is: at work as far as is known, for the moment not, or for good not. */
export type Maker = 'works' | 'interrupted' | 'failed';

export interface PhaseInputs {
  connected: boolean;
  everConnected: boolean;
  failures: number;
  /** A lesson was played, and the box said goodbye. */
  replayEnded: boolean;
  /** A figure with at least one seen joint was drawn on this connection. */
  hasFigure: boolean;
  stale: boolean;
  /** However fresh the figure is, without its maker no newer one comes. */
  maker: Maker;
  /** Frames were dropped as too late, just now. */
  dropping: boolean;
  /** The box has looked for a pupil, and there is none. */
  nobody: boolean;
}

/** Attempts that may fail before "connecting" becomes "no connection". */
const PATIENCE = 3;

export function phaseOf(inputs: PhaseInputs): Exclude<Phase, 'unable'> {
  if (!inputs.connected && inputs.replayEnded) return 'ended';
  if (!inputs.connected) return inputs.everConnected || inputs.failures >= PATIENCE ? 'offline' : 'connecting';
  if (inputs.maker === 'failed') return 'failed';
  if (inputs.hasFigure && !inputs.stale && inputs.maker === 'works') return 'live';
  if (inputs.dropping && inputs.maker === 'works') return 'late';
  if (inputs.nobody) return 'waiting';
  return inputs.hasFigure ? 'stale' : 'searching';
}

const MAKES_THE_FIGURE = 'fusion';

export function makerOf(status: Pick<Status, 'processes'> | null): Maker {
  const state = status?.processes.find((process) => process.name === MAKES_THE_FIGURE)?.state;
  if (state === 'failed') return 'failed';
  return state === undefined || state === 'ok' || state === 'degraded' ? 'works' : 'interrupted';
}
