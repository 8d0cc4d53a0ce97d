import type { Status } from '../protocol/messages';

/** What the page may claim about the figure. Only `live` is coloured. */
export type Phase =
  | 'connecting' // no connection yet
  | 'offline' // the connection is gone
  | 'waiting' // connected; no pupil is seen
  | 'stale' // a figure is there, and it is old
  | 'late' // frames come, and all of them too late: the network is too slow
  | 'unable' // this browser draws nothing in 3D
  | 'live';

export interface PhaseInputs {
  connected: boolean;
  everConnected: boolean;
  failures: number;
  /** A figure with at least one seen joint was drawn on this connection. */
  hasFigure: boolean;
  stale: boolean;
  /** The box says that what makes the figure is gone or hangs: however fresh, no newer one comes. */
  interrupted: boolean;
  /** Frames were dropped as too late, just now. */
  dropping: boolean;
  pupil: 'unknown' | 'searching' | 'found';
}

/** Attempts that may fail before "connecting" becomes "no connection". */
const PATIENCE = 3;

export function phaseOf(inputs: PhaseInputs): Exclude<Phase, 'unable'> {
  if (!inputs.connected) return inputs.everConnected || inputs.failures >= PATIENCE ? 'offline' : 'connecting';
  if (inputs.hasFigure && !inputs.stale && !inputs.interrupted) return 'live';
  if (inputs.dropping) return 'late';
  return inputs.hasFigure && inputs.pupil !== 'searching' ? 'stale' : 'waiting';
}

const MAKES_THE_FIGURE = 'fusion';

/** The process that makes the figure is known to make none now. */
export function figureInterrupted(status: Pick<Status, 'processes'> | null): boolean {
  const maker = status?.processes.find((process) => process.name === MAKES_THE_FIGURE);
  return maker !== undefined && (maker.state === 'gone' || maker.state === 'silent' || maker.state === 'failed');
}
