import type { Status } from '../protocol/messages';

const JUDGES_ATTEMPTS = 'evaluation';

/** What judges attempts is at work, as far as is known. */
export function isJudging(status: Pick<Status, 'processes'> | null): boolean {
  const state = status?.processes.find((process) => process.name === JUDGES_ATTEMPTS)?.state;
  return state === 'ok' || state === 'degraded' || state === 'starting';
}
