import type { Mesh } from 'three';
import { Level } from '../protocol/attemptReplay';
import { JointState } from '../protocol/motionFrame';
import type { Judged } from './judged';
import type { Palette } from './materials';

/** So many points of the face make a head seen, and one that is as it should be; one alone may say that it is not. */
const FACE_QUORUM = 2;

/**
 * A piece of the figure, and the joints that it is as good as: `each` shows the level of each of them where it is; a `face` has
 * one, of points that stand for one another; hands and feet are only `drawn` along, from the last of their joints on, and nobody
 * judges them.
 */
export class Part {
  /** Made when it is needed. */
  judged: Judged | undefined;

  constructor(
    readonly mesh: Mesh,
    readonly palette: Palette,
    private readonly joints: readonly number[],
    private readonly kind: 'each' | 'face' | 'drawn' = 'each',
  ) {}

  /** How far the part may be believed. */
  state(states: Uint8Array): number {
    const own = this.joints.map((joint) => states[joint]!).sort((a, b) => a - b);
    return this.kind === 'face' ? own.at(-FACE_QUORUM)! : own[0]!;
  }

  /** Whether anybody can judge it. */
  get isJudged(): boolean {
    return this.kind !== 'drawn';
  }

  /** A level for each of up to four joints of the geometry. What is drawn along is grey where the limb's end is not judged. */
  levels(levels: Uint8Array): [number, number, number, number] {
    const own = this.joints.map((joint) => levels[joint]!);
    if (this.kind === 'each') return [own[0]!, own[1] ?? Level.Grey, own[2] ?? Level.Grey, own[3] ?? Level.Grey];
    const one = this.kind === 'face' ? together(own) : own.at(-1)!;
    return [one, Level.Grey, Level.Grey, Level.Grey];
  }
}

/** The level of a face: of its points the worst, and none if fewer were judged than show that it is good. The same on paper. */
export function together(levels: readonly number[]): number {
  const known = levels.filter((level) => level !== Level.Grey);
  const worst = Math.max(Level.Grey, ...known);
  return worst > Level.Green || known.length >= FACE_QUORUM ? worst : Level.Grey;
}

/** Only what was seen is coloured. */
export function lookOf(state: number): keyof Palette {
  return state === JointState.Seen ? 'seen' : state === JointState.Guessed ? 'guessed' : 'unknown';
}
