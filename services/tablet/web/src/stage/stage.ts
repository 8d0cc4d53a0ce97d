import { PCFShadowMap, PerspectiveCamera, Scene, Vector3, WebGLRenderer } from 'three';
import { Figure } from '../figure/figure';
import { standing, type Pose } from '../figure/pose';
import { Joint } from '../figure/skeleton';
import { Floor } from './floor';
import { firstDistanceM, firstView, follow, hips, lightOffset, standpoint } from './framing';
import { keyLight, skyLight } from './light';
import { Orbit } from './orbit';
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
  private readonly wish = wishedQuality(location.href);
  private quality: Quality = this.wish ?? (hasSoftwareOnly() ? 'light' : 'full');
  private readonly pace = new PaceWatch();
  private requested = 0;
  private requestedMs = 0;
  private lastMs = 0;

  /**
   * @param canvas where to draw
   * @param beforeDraw called before each picture; hands over the newest pose by `show`
   * @param afterDraw called when it is drawn
   */
  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly beforeDraw: () => void,
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
    this.pose = pose;
    this.figure.show(pose);
    standpoint(pose, this.stand);
    this.light.target.position.copy(this.stand).setZ(0);
    this.light.position.copy(this.light.target.position).add(this.lightOffset);
    this.floor.place(this.stand, hips(pose, new Vector3()), this.joint(Joint.LeftAnkle), this.joint(Joint.RightAnkle));
    this.requestDraw();
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
    this.beforeDraw();
    const seconds = Math.min((nowMs - this.lastMs) / 1000, 0.1);
    this.lastMs = nowMs;
    this.orbit.carry(follow(this.orbit.target, this.stand, seconds, new Vector3()));
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

  private joint(index: number): Vector3 {
    return new Vector3().fromArray(this.pose.positionsM, 3 * index);
  }

  private resize(): void {
    const { clientWidth, clientHeight } = this.canvas;
    if (clientWidth === 0 || clientHeight === 0) return;
    this.camera.aspect = clientWidth / clientHeight;
    this.camera.updateProjectionMatrix();
    if (!this.orbit.touched) this.orbit.setDistance(firstDistanceM(this.camera));
    this.setPixels();
  }

  private setPixels(): void {
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, this.quality === 'full' ? MAX_PIXEL_RATIO : 1));
    this.renderer.setSize(this.canvas.clientWidth, this.canvas.clientHeight, false);
    this.requestDraw();
  }
}
