import { figureAgeMs, Freshness, STALE_AFTER_MS, TOO_LATE_MS, underWayMs } from './connection/freshness';
import { isDistant, Lateness } from './connection/lateness';
import { Link } from './connection/link';
import { makerOf, phaseOf, type Phase } from './connection/phase';
import { TaughtWords } from './connection/taughtWords';
import { complete, showsSomebody, standing, unsure, type Pose } from './figure/pose';
import { JointState, MotionFrameError, readMotionFrame, type MotionFrame } from './protocol/motionFrame';
import type { Attempt, AttemptList, Status } from './protocol/messages';
import { Replays } from './replay/replays';
import type { ReplayShow } from './replay/show.svelte';
import type { Lesson } from './state/lesson.svelte';
import type { Room } from './state/room.svelte';
import { Search } from './state/search';
import { Stage } from './stage/stage';
import { suggest } from './text/words.svelte';

/** Words change at most so often: nobody can read faster. */
const WORDS_PERIOD_MS = 250;
/** A figure that has halted loses its colour at most so much later. */
const HALTS_PERIOD_MS = 100;
const DELAY_GAIN = 0.15;
const SECOND_MS = 1000;

/** Joins the connection, the stage and the words. Holds the figure outside of the reactive state. */
export class Viewer {
  readonly replays: Replays;
  private readonly link: Link;
  private readonly stage: Stage;
  private readonly freshness = new Freshness();
  private readonly lateness = new Lateness(isDistant(location.hostname));
  private readonly search = new Search();
  private readonly taught: TaughtWords;
  private readonly words: ReturnType<typeof setInterval>;
  private readonly halts: ReturnType<typeof setInterval>;
  private waiting: MotionFrame | null = null;
  private underWay = 0;
  private pose: Pose = standing();
  private hasFigure = false;
  /** A lesson is played, or was when the box was heard last. */
  private played = false;
  private droppedMs = -Infinity;
  private delayMs: number | null = null;
  private figures = 0;
  private turnMs = performance.now();
  /** Since then the pupil has moved without a pause, as far as the box tells; null while he stands, or is not seen. */
  private movesSinceMs: number | null = null;
  /** By the box's clock, when it was heard last. */
  private heardBoxUs = -Infinity;
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
    this.replays = new Replays(
      show,
      this.stage,
      () => this.showLive(),
      () => (this.room.unreadable += 1),
    );
    this.taught = new TaughtWords((teaching) => {
      lesson.teaching = teaching;
      suggest(teaching.languages[0]);
    });
    const scheme = location.protocol === 'https:' ? 'wss' : 'ws';
    this.link = new Link(`${scheme}://${location.host}/ws`, {
      motion: (buffer) => this.receive(buffer),
      status: (status) => this.learn(status),
      attempts: (list) => this.note(list),
      changed: () => this.changed(),
    });
    // Who turns the view looks at the replay.
    canvas.addEventListener('pointerdown', () => this.replays.touch());
    this.link.start();
    this.words = setInterval(() => this.turnComes(), WORDS_PERIOD_MS);
    this.halts = setInterval(() => this.freshness.isHalted(performance.now()) && this.fade(), HALTS_PERIOD_MS);
  }

  resetView(): void {
    this.stage.resetView();
  }

  turn(azimuthDeg: number, elevationDeg: number, nearer: number): void {
    this.stage.turn(azimuthDeg, elevationDeg, nearer);
  }

  /** What pupils shall do from now on; null is whatever the box recognises. */
  choose(activity: string | null): void {
    this.lesson.activity.ask(activity, performance.now());
    this.link.choose(activity);
  }

  /** Who is up from now on; null is nobody who is named. */
  call(pupil: string | null): void {
    this.lesson.pupil.ask(pupil, performance.now());
    this.link.call(pupil);
  }

  /** Whose an attempt was after all. The box tells all tablets. */
  correct(attempt: number, pupil: string | null): void {
    this.lesson.correct(attempt, pupil, performance.now());
    this.link.correct(attempt, pupil);
  }

  /** The list of attempts begins anew, on all tablets. */
  beginAnew(): void {
    this.lesson.beginAnew(performance.now());
    this.link.beginAnew();
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
    clearInterval(this.halts);
    this.link.stop();
    this.stage.dispose();
  }

  private learn(status: Status): void {
    const nowMs = performance.now();
    this.compareClocks(status.box_time_us);
    this.room.status = status;
    void this.taught.hear(status.teaching);
    this.played = status.replay !== null;
    this.lesson.activity.confirm(status.evaluation.activity);
    this.lesson.pupil.confirm(status.evaluation.pupil);
    this.movesSinceMs = status.evaluation.state === 'moving' ? (this.movesSinceMs ?? nowMs) : null;
    if (this.movesSinceMs !== null && this.replays.isOver(nowMs, this.movesSinceMs)) this.giveWay();
    this.lateness.noteStatus(status, nowMs);
    this.search.note(status, nowMs);
    this.say();
  }

  /** The pupil tries again. Words of an earlier attempt that somebody reads stay until the next one has ended. */
  private giveWay(): void {
    if (this.lesson.isNewest) this.lesson.show(null);
    this.replays.stop();
  }

  /** The box told of its list: an attempt ended, one was given to another pupil, the list began anew, or this page has just come. */
  private note(list: AttemptList): void {
    const nowMs = performance.now();
    const boxMs = this.link.clock.boxMs(nowMs) ?? (this.room.status ? this.room.status.box_time_us / 1000 : null);
    const news = this.lesson.take(list, boxMs, this.room.status?.replay?.speed ?? 1);
    const listed = new Set(list.attempts.map(({ id }) => id));
    this.replays.keepOnly(listed);
    if (this.show.id !== null && !listed.has(this.show.id)) this.backToLive();
    if (news === null || this.replays.held(nowMs)) return;
    this.lesson.show(news.id);
    void this.replays.start(news);
  }

  /** The clock of a box goes back when it was started again, and then gives the same names to other attempts. */
  private compareClocks(boxUs: number): void {
    if (boxUs < this.heardBoxUs) {
      this.lesson.forget();
      this.replays.keepOnly(new Set());
      this.backToLive();
    }
    this.heardBoxUs = boxUs;
  }

  private showLive(): void {
    this.stage.show(this.isSure(performance.now()) ? this.pose : unsure(this.pose));
    if (this.hasFigure) this.stage.frameOnce();
  }

  private turnComes(): void {
    const nowMs = performance.now();
    // A page that nobody sees is called seldom on purpose.
    if (!document.hidden) this.lateness.noteTurn(nowMs - this.turnMs - WORDS_PERIOD_MS, nowMs);
    this.turnMs = nowMs;
    this.lesson.elapse(nowMs);
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
      this.stage.show(this.freshness.isHalted(nowMs) ? unsure(this.pose) : this.pose);
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
      this.lesson.reconnect();
      this.taught.reconnect();
    } else {
      this.room.status = null; // what was known of the cameras is no longer; of attempts it is
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
      replayEnded: this.link.endedOnPurpose && this.played,
      hasFigure: this.hasFigure,
      stale: this.freshness.isStale(nowMs),
      maker: makerOf(this.room.status),
      dropping: nowMs - this.droppedMs < STALE_AFTER_MS,
      nobody: this.search.inVain(nowMs),
    });
    this.room.phase = phase;
    if (!this.isSure(nowMs)) this.fade();
    this.room.lateCause = this.lateness.cause(nowMs);
    this.room.figureAgeS = this.hasFigure ? Math.floor(this.freshness.ageMs(nowMs) / 1000) : null;
    // What is played is as old as its lesson.
    this.room.delayMs = phase === 'live' && !this.room.status?.replay ? this.delayMs : null;
    this.room.roundTripMs = this.link.clock.roundTripMs;
    this.tellTime(nowMs);
    this.countFigures(nowMs);
    this.expose(phase);
  }

  private isSure(nowMs: number): boolean {
    return this.room.phase === 'live' && !this.freshness.isHalted(nowMs);
  }

  /** What is on the stage is no longer what the pupil does. */
  private fade(): void {
    if (this.replays.onStage || this.stage.colouredShare === 0) return;
    this.stage.show(unsure(this.pose));
    this.exposeColour();
  }

  /** By the second: ages are told in minutes. */
  private tellTime(nowMs: number): void {
    const boxMs = this.link.clock.boxMs(nowMs);
    if (boxMs !== null && Math.abs(boxMs - (this.room.boxMs ?? -Infinity)) >= SECOND_MS) this.room.boxMs = boxMs;
  }

  private countFigures(nowMs: number): void {
    const elapsedMs = nowMs - this.counted.atMs;
    if (elapsedMs < 1000) return;
    this.room.drawnHz = ((this.figures - this.counted.figures) * 1000) / elapsedMs;
    this.counted = { figures: this.figures, atMs: nowMs };
  }

  private exposeColour(): void {
    this.root.dataset['coloured'] = this.stage.colouredShare.toFixed(2);
  }

  private expose(phase: Phase): void {
    const data = this.root.dataset;
    data['phase'] = phase;
    data['figures'] = String(this.figures);
    data['drawn'] = String(this.stage.drawn);
    this.exposeColour();
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
