import { AttemptReplayError, readAttemptReplay, type AttemptReplay } from '../protocol/attemptReplay';
import type { Attempt } from '../protocol/messages';
import type { Stage } from '../stage/stage';
import { Player, type Speed } from './player';
import {
  amiss,
  hasStandard,
  heightM,
  mirrored,
  momentAt,
  whole,
  type Mirror,
  type Moment,
  type StandardShown,
} from './scene';
import type { ReplayShow } from './show.svelte';

/** So long after a teacher's last touch a replay is not taken away by the next pupil. */
export const HELD_MS = 30_000;
/** Replays that are kept on the tablet: a second look asks the box for nothing, and is possible without a connection to it. */
const KEPT = 8;
/** After so long a replay does not arrive any more. */
export const PATIENCE_MS = 8000;
/** A replay that stands still from the start was looked at by then. */
export const LOOKED_AT_MS = 6000;

/** Fetches the replays of attempts and plays them on the stage. Holds their poses outside of the reactive state. */
export class Replays {
  private readonly kept = new Map<number, AttemptReplay>();
  private replay: AttemptReplay | null = null;
  private player: Player | null = null;
  private mirror: Mirror | null = null;
  private heldUntilMs = -Infinity;
  private dirty = false;
  private leapt = false;
  private fetching: AbortController | null = null;
  private wanted: Attempt | null = null;
  private askedMs = -Infinity;
  private shownMs = -Infinity;
  private readonly reducedMotion = matchMedia('(prefers-reduced-motion: reduce)');
  /** Levels of the joints in the picture that was drawn last; null while none is drawn. */
  levels: Uint8Array | null = null;
  /** Called with each picture, and when another replay begins. */
  moved: ((positionS: number) => void) | null = null;

  /**
   * @param stopped called when the stage is free again
   * @param unreadable called when what came is no replay
   */
  constructor(
    private readonly show: ReplayShow,
    private readonly stage: Stage,
    private readonly stopped: () => void,
    private readonly unreadable: () => void,
  ) {}

  /** A replay has the place of the live figure. */
  get onStage(): boolean {
    return this.player !== null;
  }

  get positionS(): number {
    return this.player?.positionS ?? 0;
  }

  /** Somebody looks at a replay and has touched it a moment ago. */
  held(nowMs: number): boolean {
    return this.show.on && nowMs < this.heldUntilMs;
  }

  /**
   * The pupil moves since `sinceMs`: is that the end of the replay? Not while somebody looks at it, nor if it is how he ended what is
   * shown, and not before that was to be seen once, as whoever has tried something walks back first.
   */
  isOver(nowMs: number, sinceMs: number): boolean {
    const player = this.player;
    if (!this.show.on || this.held(nowMs) || sinceMs < this.askedMs) return false;
    if (player === null) return this.show.phase !== 'loading';
    return player.rounds > 0 || (!player.playing && nowMs - this.shownMs >= LOOKED_AT_MS);
  }

  get rounds(): number {
    return this.player?.rounds ?? 0;
  }

  /** Of attempts that the box does not list any more nothing is kept. */
  keepOnly(listed: ReadonlySet<number>): void {
    for (const id of [...this.kept.keys()]) if (!listed.has(id)) this.kept.delete(id);
    this.show.kept = new Set(this.kept.keys());
  }

  /** Somebody touched the replay, or asked for it. */
  touch(): void {
    this.heldUntilMs = performance.now() + HELD_MS;
  }

  /** Shows an attempt, as soon as its replay is there. */
  async start(attempt: Attempt): Promise<void> {
    this.cancel();
    this.heldUntilMs = -Infinity;
    this.show.id = attempt.id;
    this.wanted = attempt;
    this.askedMs = performance.now();
    let replay = this.kept.get(attempt.id) ?? null;
    if (replay === null) {
      this.show.phase = 'loading';
      this.release();
      const fetching = (this.fetching = new AbortController());
      const fetched = await fetchReplay(attempt.id, fetching);
      if (this.fetching !== fetching) return; // somebody wants something else by now
      if (fetched === 'unreadable') this.unreadable();
      if (typeof fetched === 'string') {
        this.show.phase = fetched === 'gone' ? 'missing' : 'failed';
        return;
      }
      replay = fetched;
    }
    this.keep(attempt.id, replay);
    this.begin(replay, attempt.handed);
  }

  /** Asks once more for a replay that did not arrive. */
  again(): void {
    if (this.wanted === null) return;
    void this.start(this.wanted);
    this.touch();
  }

  /** Back to the live figure. */
  stop(): void {
    this.cancel();
    this.wanted = null;
    if (!this.show.on) return;
    this.show.phase = 'off';
    this.show.id = null;
    this.heldUntilMs = -Infinity;
    this.release();
  }

  toggle(): void {
    this.touch();
    this.player?.toggle();
    this.changed();
  }

  seek(positionS: number): void {
    this.touch();
    this.player?.seek(positionS);
    this.changed(true);
  }

  seekKeyframe(index: number): void {
    this.touch();
    this.player?.seekKeyframe(index);
    this.changed(true);
  }

  setSpeed(speed: Speed): void {
    this.touch();
    this.show.speed = speed;
    if (this.player) this.player.speed = speed;
  }

  setStandard(standard: StandardShown): void {
    this.touch();
    this.show.standard = standard;
    this.stage.frameAttempt(standard === 'beside' && this.show.hasStandard);
    this.changed();
  }

  setMirror(on: boolean): void {
    this.touch();
    this.show.mirror = on;
    this.mirror = on ? this.stage.mirror() : null;
    this.changed(true);
  }

  /** The next picture of a replay, `elapsedS` after the one before; false if there is none to draw. */
  draw(elapsedS: number): boolean {
    const { player, replay } = this;
    if (player === null || replay === null) return false;
    const before = player.positionS;
    if (player.advance(elapsedS)) this.dirty = true;
    if (player.positionS < before) this.leapt = true;
    if (player.playing) this.stage.requestDraw();
    if (this.dirty) this.put(momentAt(replay, player.positionS));
    return true;
  }

  private begin(replay: AttemptReplay, handed: Attempt['handed']): void {
    const keyframesS = replay.keyframes.map((frame) => frame * replay.frameS);
    const player = new Player((replay.frames - 1) * replay.frameS, keyframesS);
    player.speed = this.show.speed;
    this.replay = replay;
    this.player = player;
    this.show.lengthS = player.lengthS;
    this.show.keyframesS = keyframesS;
    this.show.amiss = amiss(replay);
    this.show.hasStandard = hasStandard(replay);
    const pair = this.show.standard === 'beside' && this.show.hasStandard;
    this.stage.beginAttempt(momentAt(replay, 0).pose, { handed, heightM: heightM(replay) }, pair);
    this.mirror = this.show.mirror ? this.stage.mirror() : null;
    this.shownMs = performance.now();
    // Who wants no motion gets the decisive moment, and may start it.
    if (this.reducedMotion.matches) player.seekKeyframe(2);
    this.show.phase = 'shown';
    this.changed(true);
  }

  private put(moment: Moment): void {
    const shown = this.mirror ? mirrored(moment, this.mirror) : moment;
    this.levels = moment.levels;
    this.stage.showAttempt(shown, this.show.standard, this.leapt);
    this.dirty = this.leapt = false;
    this.moved?.(this.positionS);
  }

  private changed(leapt = false): void {
    this.show.playing = this.player?.playing ?? false;
    this.dirty = true;
    this.leapt ||= leapt;
    this.stage.requestDraw();
  }

  private cancel(): void {
    this.fetching?.abort();
    this.fetching = null;
  }

  private release(): void {
    const drawn = this.player !== null;
    this.player = this.replay = this.levels = null;
    if (drawn) {
      this.stage.endAttempt();
      this.stopped();
    }
  }

  private keep(id: number, replay: AttemptReplay): void {
    this.kept.delete(id);
    this.kept.set(id, replay);
    for (const oldest of this.kept.keys()) {
      if (this.kept.size <= KEPT) break;
      this.kept.delete(oldest);
    }
    this.show.kept = new Set(this.kept.keys());
  }
}

/** The replay of an attempt, or why there is none: the box has it no more, it did not arrive, or what came is none. */
async function fetchReplay(
  id: number,
  fetching: AbortController,
): Promise<AttemptReplay | 'gone' | 'lost' | 'unreadable'> {
  const late = setTimeout(() => fetching.abort(), PATIENCE_MS);
  try {
    const response = await fetch(`/api/attempts/${id}/replay`, { signal: fetching.signal });
    if (!response.ok) return response.status === 404 ? 'gone' : 'lost';
    return whole(readAttemptReplay(await response.arrayBuffer()));
  } catch (error) {
    return error instanceof AttemptReplayError ? 'unreadable' : 'lost';
  } finally {
    clearTimeout(late);
  }
}
