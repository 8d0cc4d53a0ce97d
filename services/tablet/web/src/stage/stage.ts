import { PCFShadowMap, PerspectiveCamera, Scene, Vector3, WebGLRenderer } from 'three';
import { Figure } from '../figure/figure';
import { standing, type Pose } from '../figure/pose';
import { CANVAS_PX } from '../figure/judged';
import { Joint } from '../figure/skeleton';
import { moved, type Mirror, type Moment, type StandardShown } from '../replay/scene';
import { Floor } from './floor';
import {
  BESIDE_M,
  attemptDistanceM,
  attemptLight,
  attemptView,
  facingRad,
  firstDistanceM,
  firstView,
  follow,
  hips,
  lightOffset,
  standpoint,
  type Framed,
} from './framing';
import { keyLight, skyLight } from './light';
import { Orbit, type View } from './orbit';
import { PaceWatch, hasSoftwareOnly, wishedQuality, type Quality } from './quality';

const MAX_PIXEL_RATIO = 1.5;

/** The scene: figure, floor, light and view. Draws when something changed, at most once a screen refresh, and not otherwise. */
export class Stage {
  /** Pictures drawn since the page was opened. */
  drawn = 0;

  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(32, 1, 0.1, 60);
  private readonly light = keyLight();
  private readonly figure = new Figure();
  private readonly floor = new Floor();
  private readonly orbit: Orbit;
  private readonly observer: ResizeObserver;
  private readonly stand = new Vector3();
  private lightOffset = lightOffset(standing());
  private pose: Pose = standing();
  private framed = false;
  /** Made when the first replay is shown. */
  private standard: Figure | null = null;
  /** How an attempt is looked at, and how the live figure was before; null while the figure is live. */
  private attempt: (Framed & { before: View; lightBefore: Vector3 }) | null = null;
  private pair = false;
  private leapt = false;
  private readonly wish = wishedQuality(location.href);
  private quality: Quality = this.wish ?? (hasSoftwareOnly() ? 'light' : 'full');
  private readonly pace = new PaceWatch();
  private requested = 0;
  private requestedMs = 0;
  private lastMs = 0;

  /**
   * @param canvas where to draw
   * @param beforeDraw called before each picture with the seconds since the last one; hands over the newest pose by `show`
   * @param afterDraw called when it is drawn
   */
  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly beforeDraw: (elapsedS: number) => void,
    private readonly afterDraw: () => void,
  ) {
    this.renderer = new WebGLRenderer({ canvas, antialias: this.quality === 'full', alpha: true });
    this.renderer.shadowMap.enabled = this.quality === 'full';
    this.renderer.shadowMap.type = PCFShadowMap;
    this.camera.up.set(0, 0, 1);
    this.orbit = new Orbit(this.camera, canvas, () => this.requestDraw());
    this.scene.add(this.figure.group, this.floor.group, this.light, this.light.target, skyLight());
    this.show(this.pose);
    this.resetView(false);
    canvas.addEventListener('webglcontextrestored', () => this.requestDraw());
    this.observer = new ResizeObserver(() => this.resize());
    this.observer.observe(canvas);
  }

  /** Share of the figure that is in colour. */
  get colouredShare(): number {
    return this.figure.colouredShare;
  }

  /** Angle of the view about the vertical, in degrees. */
  get azimuthDeg(): number {
    return this.orbit.azimuthDeg;
  }

  /** Puts the figure into a pose with the next picture. */
  show(pose: Pose): void {
    this.figure.show(pose);
    this.stageAt(pose);
    this.requestDraw();
  }

  /** An attempt is shown in the place of the live figure from now on. */
  beginAttempt(pose: Pose, seen: Omit<Framed, 'facing'>, pair: boolean): void {
    this.figure.forgetSize();
    this.standard?.forgetSize();
    const { before, lightBefore } = this.attempt ?? { before: this.orbit.view, lightBefore: this.lightOffset };
    this.attempt = { ...seen, facing: facingRad(pose), before, lightBefore };
    this.lightOffset = attemptLight(this.attempt);
    this.pose = pose;
    this.orbit.touched = false;
    this.frameAttempt(pair, false);
  }

  /** Looks at the attempt, and at the standard where it stands beside, unless somebody has chosen how. */
  frameAttempt(pair: boolean, gently = true): void {
    this.pair = pair;
    if (this.attempt === null || this.orbit.touched) return;
    const target = standpoint(this.pose, new Vector3());
    const position = attemptView(this.attempt, target, this.camera, pair);
    this.orbit.moveTo(target, position, gently);
    this.requestDraw();
  }

  /** A moment of an attempt. `leapt`: it does not follow upon the one before. */
  showAttempt({ pose, levels, standard }: Moment, shown: StandardShown, leapt: boolean): void {
    // Also in a frame without a standard, so that the pupil does not leap aside.
    const half = this.right().multiplyScalar(this.pair ? BESIDE_M / 2 : 0);
    const aside = moved(pose, [-half.x, -half.y]);
    this.figure.showJudged(aside, levels);
    this.stageAt(pose, aside);
    this.leapt ||= leapt;
    this.showStandard(shown === 'off' ? null : standard && moved(standard, [half.x, half.y]), this.pair);
  }

  /** The live figure is shown again, from where it was looked at before. */
  endAttempt(): void {
    if (this.attempt === null) return;
    const { before, lightBefore } = this.attempt;
    this.attempt = null;
    this.lightOffset = lightBefore;
    this.pair = false;
    this.figure.forgetSize();
    this.showStandard(null, false);
    this.orbit.restore(before, before.target);
    this.leapt = true;
  }

  /** What turns the picture's right into its left. */
  mirror(): Mirror {
    const right = this.right();
    return { at: [this.orbit.target.x, this.orbit.target.y], across: [right.x, right.y] };
  }

  private showStandard(pose: Pose | null, beside: boolean): void {
    if (pose !== null && this.standard === null) {
      this.standard = Figure.seenThrough();
      this.scene.add(this.standard.group);
    }
    if (this.standard === null) return;
    this.standard.group.visible = pose !== null;
    if (pose === null) return;
    if (beside) this.standard.show(pose);
    else this.standard.showGhost(pose);
  }

  /** The level direction that points to the right on the screen. */
  private right(): Vector3 {
    return new Vector3().setFromMatrixColumn(this.camera.matrixWorld, 0).setZ(0).normalize();
  }

  private stageAt(pose: Pose, drawn = pose): void {
    this.pose = pose;
    standpoint(pose, this.stand);
    this.light.target.position.copy(this.stand).setZ(0);
    this.light.position.copy(this.light.target.position).add(this.lightOffset);
    const joint = (index: number): Vector3 => new Vector3().fromArray(drawn.positionsM, 3 * index);
    this.floor.place(this.stand, hips(drawn, new Vector3()), joint(Joint.LeftAnkle), joint(Joint.RightAnkle));
  }

  /** Another beginning, perhaps with another person: size and view are chosen anew with the next pose. */
  startAnew(): void {
    this.figure.forgetSize();
    this.framed = false;
  }

  /** Chooses the first view of this pose, once, unless somebody has chosen a view already. */
  frameOnce(): void {
    if (this.framed) return;
    this.framed = true;
    if (!this.orbit.touched) this.resetView(false);
  }

  /** Back to the first view, from where the pupil is now. */
  resetView(gently = true): void {
    if (this.attempt !== null) {
      this.orbit.touched = false;
      this.frameAttempt(this.pair, gently);
      return;
    }
    const target = standpoint(this.pose, new Vector3());
    this.lightOffset = lightOffset(this.pose);
    this.orbit.moveTo(target, firstView(this.pose, target, this.camera), gently);
  }

  /** Turns the view, in degrees, or brings it nearer by a factor: for the keyboard. */
  turn(azimuthDeg: number, elevationDeg: number, nearer: number): void {
    this.orbit.turn(azimuthDeg, elevationDeg, nearer);
  }

  requestDraw(): void {
    if (this.requested !== 0) return;
    this.requestedMs = performance.now();
    this.requested = requestAnimationFrame((nowMs) => this.draw(nowMs));
  }

  dispose(): void {
    cancelAnimationFrame(this.requested);
    this.requested = -1; // no picture is requested any more
    this.observer.disconnect();
    this.orbit.dispose();
    this.renderer.dispose();
  }

  private draw(nowMs: number): void {
    this.requested = 0;
    const waitedMs = performance.now() - this.requestedMs;
    if (this.wish === null && this.quality === 'full' && this.pace.tooSlow(waitedMs)) this.drawLight();
    const seconds = Math.min((nowMs - this.lastMs) / 1000, 0.1);
    this.lastMs = nowMs;
    this.beforeDraw(seconds);
    const followedS = this.leapt ? Infinity : seconds;
    this.leapt = false;
    this.orbit.carry(follow(this.orbit.target, this.stand, followedS, new Vector3()));
    if (this.orbit.update(nowMs)) this.requestDraw();
    this.renderer.render(this.scene, this.camera);
    this.drawn += 1;
    this.afterDraw();
  }

  /** Gives up shadows and fine pixels; smooth edges cannot be given up without a new canvas. */
  private drawLight(): void {
    this.quality = 'light';
    this.light.castShadow = false;
    this.setPixels();
  }

  private resize(): void {
    const { clientWidth, clientHeight } = this.canvas;
    if (clientWidth === 0 || clientHeight === 0) return;
    this.camera.aspect = clientWidth / clientHeight;
    this.camera.updateProjectionMatrix();
    if (!this.orbit.touched) this.orbit.setDistance(this.distanceM());
    this.setPixels();
    // A canvas that changes its size is empty, and a busy tablet comes late to the next picture.
    this.renderer.render(this.scene, this.camera);
  }

  private distanceM(): number {
    return this.attempt ? attemptDistanceM(this.camera, this.attempt, this.pair) : firstDistanceM(this.camera);
  }

  private setPixels(): void {
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, this.quality === 'full' ? MAX_PIXEL_RATIO : 1));
    this.renderer.setSize(this.canvas.clientWidth, this.canvas.clientHeight, false);
    this.renderer.getDrawingBufferSize(CANVAS_PX.value);
    this.requestDraw();
  }
}
