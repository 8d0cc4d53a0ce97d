/** Names for the generated types, and the reading of the server's JSON. */

import type { components } from './openapi';

export type Status = components['schemas']['Status'];
export type CameraStatus = components['schemas']['CameraStatus'];
export type ProcessStatus = components['schemas']['ProcessStatus'];
export type MachineStatus = components['schemas']['MachineStatus'];
export type MachineCode = MachineStatus['troubles'][number];
export type CalibrationCode = NonNullable<Status['calibration']>;
export type EvaluationStatus = Status['evaluation'];
export type Attempt = components['schemas']['Attempt'];
export type AttemptList = components['schemas']['AttemptList'];
export type AttemptMeasure = components['schemas']['AttemptMeasure'];
export type Verdict = AttemptMeasure['verdict'];
export type Silence = NonNullable<Attempt['silence']>;
export type Teaching = components['schemas']['Teaching'];
export type Pong = components['schemas']['Pong'];
export type Ping = components['schemas']['Ping'];
export type Ack = components['schemas']['Ack'];
export type Anew = components['schemas']['Anew'];
export type Choose = components['schemas']['Choose'];
export type Turn = components['schemas']['Turn'];
export type Correction = components['schemas']['Correction'];

export type ServerMessage = Status | AttemptList | Pong;
const KINDS: ReadonlySet<unknown> = new Set<ServerMessage['type']>(['status', 'attempts', 'pong']);

/** A message of the server, or null for a kind that this page does not know (a newer box). */
export function readServerMessage(text: string): ServerMessage | null {
  const message = JSON.parse(text) as { type?: unknown };
  return KINDS.has(message.type) ? (message as ServerMessage) : null;
}
