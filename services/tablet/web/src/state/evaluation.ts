import type { Status } from '../protocol/messages';

const JUDGES_ATTEMPTS = 'evaluation';

/** Whether what judges attempts is at work, about to be, or neither, as far as is known. */
export type Judging = 'on' | 'starting' | 'off';

export function judging(status: Pick<Status, 'processes' | 'evaluation'>): Judging {
  const state = status.processes.find((process) => process.name === JUDGES_ATTEMPTS)?.state;
  if (state === 'ok' || state === 'degraded') return 'on';
  return state === 'starting' || status.evaluation.state === 'starting' ? 'starting' : 'off';
}

/** A lesson is to be played and has not begun: it waits for what judges attempts, at most half a minute. */
export function awaitsJudging(status: Pick<Status, 'processes' | 'evaluation' | 'replay'>): boolean {
  return status.replay?.position_s === 0 && judging(status) !== 'on';
}
