/** Where in an attempt its slow replay is. Knows nothing of poses, and no clock but the one that it is given. */

export const SPEEDS = [0.25, 0.5, 1] as const;
export type Speed = (typeof SPEEDS)[number];

/** So long the end stands still before the replay begins anew. */
const REST_S = 0.9;

export class Player {
  playing = true;
  speed: Speed = 0.5;
  /** Times that the end was reached. */
  rounds = 0;
  private restedS = 0;
  private at = 0;

  /**
   * @param lengthS of the attempt
   * @param keyframesS where the four keyframes are
   */
  constructor(
    readonly lengthS: number,
    readonly keyframesS: readonly number[],
  ) {}

  get positionS(): number {
    return this.at;
  }

  /** Time went by; true if the picture is another one now. */
  advance(elapsedS: number): boolean {
    if (!this.playing) return false;
    if (this.at >= this.lengthS) return this.rest(elapsedS);
    this.at = Math.min(this.at + elapsedS * this.speed, this.lengthS);
    if (this.at >= this.lengthS) this.rounds += 1;
    return true;
  }

  /** Goes to a moment and stays there. */
  seek(positionS: number): void {
    this.playing = false;
    this.restedS = 0;
    this.at = Math.min(Math.max(positionS, 0), this.lengthS);
  }

  seekKeyframe(index: number): void {
    this.seek(this.keyframesS[index] ?? 0);
  }

  toggle(): void {
    this.playing = !this.playing;
    if (this.playing && this.at >= this.lengthS) this.restart();
  }

  private rest(elapsedS: number): boolean {
    this.restedS += elapsedS;
    if (this.restedS < REST_S) return false;
    this.restart();
    return true;
  }

  private restart(): void {
    this.at = 0;
    this.restedS = 0;
  }
}
