/** What the machine's troubles mean for a lesson. */

import type { MachineCode } from '../protocol/messages';

/** The others are the technician's: a lesson goes on as if nothing were. */
const MATTERS: ReadonlySet<MachineCode> = new Set<MachineCode>(['disk_full', 'memory_low', 'hot', 'throttled']);

/** The worst trouble that a teacher has to know of; null if there is none. */
export function troubleForTeacher(troubles: readonly MachineCode[]): MachineCode | null {
  return troubles.find((code) => MATTERS.has(code)) ?? null;
}
