import { figureAgeMs, Freshness, STALE_AFTER_MS, TOO_LATE_MS, underWayMs } from './connection/freshness';
import { isDistant, Lateness } from './connection/lateness';
import { Link } from './connection/link';
import { makerOf, phaseOf, type Phase } from './connection/phase';
import { complete, showsSomebody, standing, unsure, type Pose } from './figure/pose';
import { JointState, MotionFrameError, readMotionFrame, type MotionFrame } from './protocol/motionFrame';
import type { Attempt, Status, Teaching } from './protocol/messages';
import { Replays } from './replay/replays';
import type { ReplayShow } from './replay/show.svelte';
import type { Lesson } from './state/lesson.svelte';
import type { Room } from './state/room.svelte';
import { Search } from './state/search';
import { Stage } from './stage/stage';
import { suggest } from './text/words.svelte';

/** Words change at most so often: nobody can read faster. */
const WORDS_PERIOD_MS = 250;
const DELAY_GAIN = 0.15;

/** Joins the connection, the stage and the words. Holds the figure outside of the reactive state. */
export class Viewer {
  readonly replays: Replays;
  private readonly link: Link;
  private readonly stage: Stage;
  private readonly freshness = new Freshness();
  private readonly lateness = new Lateness(isDistant(location.hostname));
  private readonly search = new Search();
  private readonly words: ReturnType<typeof setInterval>;
  private waiting: MotionFrame | null = null;
  private underWay = 0;
  private pose: Pose = standing();
  private hasFigure = false;
  private droppedMs = -Infinity;
  private delayMs: number | null = null;
  private figures = 0;
  private turnMs = performance.now();
  private counted = { figures: 0, atMs: performance.now() };

  /**
   * @param canvas where to draw
   * @param room, lesson, show the words' state
   * @param root carries what can be observed from outside as `data-` attributes
   */
  constructor(
    canvas: HTMLCanvasElement,
    private readonly room: Room,
    private readonly lesson: Lesson,
    private readonly show: ReplayShow,
    private readonly root: HTMLElement,
  ) {
    this.stage = new Stage(
      canvas,
      (elapsedS) => {
        this.takeNewest();
        this.replays.draw(elapsedS);
      },
      () => this.acknowledge(),
    );
    this.replays = new Replays(show, this.stage, () => this.showLive());
    const scheme = location.protocol === 'https:' ? 'wss' : 'ws';
    this.link = new Link(`${scheme}://${location.host}/ws`, {
      motion: (buffer) => this.receive(buffer),
      status: (status) => this.learn(status),
      attempt: (attempt) => this.note(attempt),
      changed: () => this.changed(),
    });
    // Who turns the view looks at the replay.
    canvas.addEventListener('pointerdown', () => this.replays.touch());
    this.link.start();
    this.words = setInterval(() => this.turnComes(), WORDS_PERIOD_MS);
  }

  resetView(): void {
    this.stage.resetView();
  }

  turn(azimuthDeg: number, elevationDeg: number, nearer: number): void {
    this.stage.turn(azimuthDeg, elevationDeg, nearer);
  }

  /** What pupils shall do from now on; null is whatever the box recognises. */
  choose(activity: string | null): void {
    this.lesson.ask(activity, performance.now());
    this.link.choose(activity);
  }

  /** Shows an attempt again, because somebody wants to see it. */
  see(attempt: Attempt): void {
    this.lesson.show(attempt.id);
    void this.replays.start(attempt);
    this.replays.touch();
  }

  /** Back to the live figure and the newest words. */
  backToLive(): void {
    this.lesson.show(null);
    this.replays.stop();
  }

  dispose(): void {
    clearInterval(this.words);
    this.link.stop();
    this.stage.dispose();
  }

  private learn(status: Status): void {
    const nowMs = performance.now();
    const moved = this.room.status?.evaluation.state === 'moving';
    this.room.status = status;
    this.lesson.confirm(status.evaluation.activity, nowMs);
    if (!moved && status.evaluation.state === 'moving' && this.replays.isOver(nowMs)) this.backToLive();
    this.lateness.noteStatus(status, nowMs);
    this.search.note(status, nowMs);
    this.say();
  }

  /** An attempt ended, or the box tells of those that did before. */
  private note(attempt: Attempt): void {
    const nowMs = performance.now();
    const boxMs = this.link.clock.boxMs(nowMs) ?? (this.room.status ? this.room.status.box_time_us / 1000 : null);
    if (!this.lesson.note(attempt, boxMs) || this.replays.held(nowMs)) return;
    this.lesson.show(attempt.id);
    void this.replays.start(attempt);
  }

  private async learnWords(): Promise<void> {
    try {
      const response = await fetch('/api/teaching');
      if (!response.ok) return;
      this.lesson.teaching = (await response.json()) as Teaching;
      suggest(this.lesson.teaching.languages[0]);
    } catch {
      // Asked again with the next connection.
    }
  }

  private showLive(): void {
    this.stage.show(this.room.phase === 'live' ? this.pose : unsure(this.pose));
    if (this.hasFigure) this.stage.frameOnce();
  }

  private turnComes(): void {
    const nowMs = performance.now();
    // A page that nobody sees is called seldom on purpose.
    if (!document.hidden) this.lateness.noteTurn(nowMs - this.turnMs - WORDS_PERIOD_MS, nowMs);
    this.turnMs = nowMs;
    this.say();
  }

  private receive(buffer: ArrayBuffer): void {
    this.underWay += 1;
    try {
      this.consider(readMotionFrame(buffer), performance.now());
    } catch (error) {
      if (!(error instanceof MotionFrameError)) throw error;
      this.room.unreadable += 1;
    }
    if (this.waiting !== null && !this.replays.onStage) {
      this.stage.requestDraw();
      return;
    }
    // A replay has the stage, and is drawn when it moves.
    if (this.replays.onStage) this.takeNewest();
    this.acknowledge();
  }

  /** A frame waits to be drawn, in the place of an older one, unless it was under way for too long. */
  private consider(frame: MotionFrame, nowMs: number): void {
    const underWay = underWayMs(frame, this.link.clock.boxMs(nowMs));
    if (underWay !== null && underWay > TOO_LATE_MS) {
      this.droppedMs = nowMs;
      this.room.droppedLate += 1;
      return;
    }
    if (frame.states.includes(JointState.Seen)) this.freshness.note(frame, nowMs);
    if (showsSomebody(frame)) this.waiting = frame;
  }

  /** The newest frame becomes the figure. */
  private takeNewest(): void {
    const frame = this.waiting;
    this.waiting = null;
    const nowMs = performance.now();
    // Guesses alone, an observation that is only repeated, or a page that was hidden: `say` turns the figure grey.
    if (frame === null || this.freshness.isStale(nowMs)) return;
    if (!this.hasFigure) this.stage.startAnew();
    this.pose = complete(frame, this.pose);
    this.hasFigure = true;
    this.figures += 1;
    if (!this.replays.onStage) {
      this.stage.show(this.pose);
      this.stage.frameOnce();
    }
    const boxMs = this.link.clock.boxMs(nowMs);
    if (boxMs !== null) this.noteDelay(figureAgeMs(frame, boxMs));
  }

  /** Every frame that came since the picture before is dealt with. Only now, so that the next ones leave the box as late as can be. */
  private acknowledge(): void {
    this.link.acknowledgeMotions(this.underWay);
    this.underWay = 0;
  }

  private noteDelay(delayMs: number): void {
    this.delayMs = this.delayMs === null ? delayMs : this.delayMs + DELAY_GAIN * (delayMs - this.delayMs);
  }

  private changed(): void {
    this.underWay = 0;
    this.waiting = null;
    this.droppedMs = -Infinity;
    if (this.link.connected) {
      this.lesson.forget(); // the box tells anew
      this.replays.forget();
      void this.learnWords();
    } else {
      this.room.status = null; // what was known of the cameras is no longer
      this.backToLive();
    }
    this.freshness.reset();
    this.lateness.reset();
    this.search.reset();
    this.hasFigure = false;
    this.delayMs = null;
    this.say();
  }

  private say(): void {
    const nowMs = performance.now();
    const phase = phaseOf({
      connected: this.link.connected,
      everConnected: this.link.everConnected,
      failures: this.link.failures,
      hasFigure: this.hasFigure,
      stale: this.freshness.isStale(nowMs),
      maker: makerOf(this.room.status),
      dropping: nowMs - this.droppedMs < STALE_AFTER_MS,
      nobody: this.search.inVain(nowMs),
    });
    if (phase !== 'live' && !this.replays.onStage && this.stage.colouredShare > 0) this.stage.show(unsure(this.pose));
    this.room.phase = phase;
    this.room.lateCause = this.lateness.cause(nowMs);
    this.room.figureAgeS = this.hasFigure ? Math.floor(this.freshness.ageMs(nowMs) / 1000) : null;
    // What is played is as old as its lesson.
    this.room.delayMs = phase === 'live' && !this.room.status?.replay ? this.delayMs : null;
    this.room.roundTripMs = this.link.clock.roundTripMs;
    this.countFigures(nowMs);
    this.expose(phase);
  }

  private countFigures(nowMs: number): void {
    const elapsedMs = nowMs - this.counted.atMs;
    if (elapsedMs < 1000) return;
    this.room.drawnHz = ((this.figures - this.counted.figures) * 1000) / elapsedMs;
    this.counted = { figures: this.figures, atMs: nowMs };
  }

  private expose(phase: Phase): void {
    const data = this.root.dataset;
    data['phase'] = phase;
    data['figures'] = String(this.figures);
    data['drawn'] = String(this.stage.drawn);
    data['coloured'] = this.stage.colouredShare.toFixed(2);
    data['stage'] = this.replays.onStage ? 'replay' : 'live';
    data['attempt'] = this.show.id === null ? '' : String(this.show.id);
    data['position'] = this.replays.positionS.toFixed(2);
    data['rounds'] = String(this.replays.rounds);
    data['levels'] = [0, 1, 2, 3]
      .map((level) => this.replays.levels?.filter((own) => own === level).length ?? 0)
      .join();
    data['azimuth'] = this.stage.azimuthDeg.toFixed(1);
  }
}
