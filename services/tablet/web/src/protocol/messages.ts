/** Names for the generated types, and the reading of the server's JSON. */

import type { components } from './openapi';

export type Status = components['schemas']['Status'];
export type CameraStatus = components['schemas']['CameraStatus'];
export type ProcessStatus = components['schemas']['ProcessStatus'];
export type MachineStatus = components['schemas']['MachineStatus'];
export type MachineCode = MachineStatus['troubles'][number];
export type CalibrationCode = NonNullable<Status['calibration']>;
export type Pong = components['schemas']['Pong'];
export type Ping = components['schemas']['Ping'];
export type Ack = components['schemas']['Ack'];

/** A message of the server, or null for a kind that this page does not know (a newer box). */
export function readServerMessage(text: string): Status | Pong | null {
  const message = JSON.parse(text) as { type?: unknown };
  return message.type === 'status' || message.type === 'pong' ? (message as Status | Pong) : null;
}
