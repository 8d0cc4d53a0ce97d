import { readAttemptReplay, type AttemptReplay } from '../protocol/attemptReplay';
import type { Attempt } from '../protocol/messages';
import type { Stage } from '../stage/stage';
import { Player, type Speed } from './player';
import { amiss, heightM, mirrored, momentAt, whole, type Mirror, type Moment, type StandardShown } from './scene';
import type { ReplayShow } from './show.svelte';

/** So long after a teacher's last touch a replay is not taken away by the next pupil. */
export const HELD_MS = 30_000;
/** Replays that are kept on the tablet, so that a second look needs no network. */
const KEPT = 8;

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
  private readonly reducedMotion = matchMedia('(prefers-reduced-motion: reduce)');
  /** Levels of the joints in the picture that was drawn last; null while none is drawn. */
  levels: Uint8Array | null = null;
  /** Called with each picture, and when another replay begins. */
  moved: ((positionS: number) => void) | null = null;

  /**
   * @param stopped called when the stage is free again
   */
  constructor(
    private readonly show: ReplayShow,
    private readonly stage: Stage,
    private readonly stopped: () => void,
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
   * The pupil moves again: is that the end of the replay? Not while somebody looks at it, and not before it was to be seen once, as
   * whoever has tried something walks back first.
   */
  isOver(nowMs: number): boolean {
    const player = this.player;
    return !this.held(nowMs) && (player === null || !player.playing || player.rounds > 0);
  }

  get rounds(): number {
    return this.player?.rounds ?? 0;
  }

  /** The box was perhaps started anew, and gives the same numbers to other attempts. */
  forget(): void {
    this.kept.clear();
  }

  /** Somebody touched the replay, or asked for it. */
  touch(): void {
    this.heldUntilMs = performance.now() + HELD_MS;
  }

  /** Shows an attempt, as soon as its replay is there. */
  async start(attempt: Attempt): Promise<void> {
    this.fetching?.abort();
    this.heldUntilMs = -Infinity;
    this.show.id = attempt.id;
    const abort = (this.fetching = new AbortController());
    let replay = this.kept.get(attempt.id) ?? null;
    if (replay === null) {
      this.show.phase = 'loading';
      this.release();
      replay = await fetched(attempt.id, abort.signal);
      if (abort.signal.aborted) return;
    }
    if (replay === null) {
      this.show.phase = 'missing';
      return;
    }
    this.keep(attempt.id, replay);
    this.begin(replay, attempt.handed);
  }

  /** Back to the live figure. */
  stop(): void {
    this.fetching?.abort();
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
    const first = momentAt(replay, 0);
    this.show.hasStandard = first.standard !== null;
    const pair = this.show.standard === 'beside' && this.show.hasStandard;
    this.stage.beginAttempt(first.pose, { handed, heightM: heightM(replay) }, pair);
    this.mirror = this.show.mirror ? this.stage.mirror() : null;
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
  }
}

async function fetched(id: number, signal: AbortSignal): Promise<AttemptReplay | null> {
  try {
    const response = await fetch(`/api/attempts/${id}/replay`, { signal });
    return response.ok ? whole(readAttemptReplay(await response.arrayBuffer())) : null;
  } catch {
    return null; // no network, or bytes that are none of ours: there is nothing to show
  }
}
