import { MathUtils, Spherical, Vector3, type PerspectiveCamera } from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';

const NEAREST_M = 1.2;
const FARTHEST_M = 12;
/** Polar angles, from straight above: not quite above, and never below the floor. */
const HIGHEST_RAD = 0.12;
const LOWEST_RAD = Math.PI / 2 - 0.02;
const RETURN_MS = 450;
/** What a turning view loses with each refresh of a screen of 60 Hz. */
const DAMPING = 0.12;
const REFRESH_MS = 1000 / 60;

/** A place to look from and a point to look at. */
export interface View {
  target: Vector3;
  position: Vector3;
  /** Somebody chose it. */
  touched: boolean;
}

interface Journey {
  fromTarget: Vector3;
  fromPosition: Vector3;
  toTarget: Vector3;
  toPosition: Vector3;
  startMs: number | null;
}

/** Turning the view by finger, mouse or key, with sensible limits, and bringing it back. */
export class Orbit {
  /** Somebody chose this view, so it is kept when the screen changes its shape. */
  touched = false;

  private readonly controls: OrbitControls;
  private readonly reducedMotion = matchMedia('(prefers-reduced-motion: reduce)');
  private journey: Journey | null = null;
  private lastMs = 0;

  constructor(
    private readonly camera: PerspectiveCamera,
    element: HTMLElement,
    changed: () => void,
  ) {
    this.controls = new OrbitControls(camera, element);
    this.controls.enableDamping = !this.reducedMotion.matches;
    this.controls.rotateSpeed = 0.75;
    this.controls.minDistance = NEAREST_M;
    this.controls.maxDistance = FARTHEST_M;
    this.controls.minPolarAngle = HIGHEST_RAD;
    this.controls.maxPolarAngle = LOWEST_RAD;
    this.controls.enablePan = false; // the view follows the pupil
    this.controls.addEventListener('change', changed);
    this.controls.addEventListener('start', () => {
      this.journey = null; // a finger goes before a journey
      this.touched = true;
      changed();
    });
  }

  get target(): Vector3 {
    return this.controls.target;
  }

  get azimuthDeg(): number {
    return MathUtils.radToDeg(this.controls.getAzimuthalAngle());
  }

  get view(): View {
    return { target: this.controls.target.clone(), position: this.camera.position.clone(), touched: this.touched };
  }

  /** Looks again as before, from the same side, wherever the pupil is by now. */
  restore(view: View, target: Vector3): void {
    this.moveTo(target, view.position.clone().sub(view.target).add(target), false);
    this.touched = view.touched;
  }

  /** Moves the view along with the pupil. */
  carry(shift: Vector3): void {
    if (shift.lengthSq() === 0) return;
    this.controls.target.add(shift);
    this.camera.position.add(shift);
  }

  /** Comes nearer or goes away without turning. */
  setDistance(distanceM: number): void {
    const offset = this.camera.position.clone().sub(this.controls.target).setLength(distanceM);
    this.camera.position.copy(this.controls.target).add(offset);
    this.controls.update();
  }

  /** Goes to another view, in an instant or in half a second. */
  moveTo(target: Vector3, position: Vector3, gently: boolean): void {
    this.touched = false;
    this.stopTurning();
    if (!gently || this.reducedMotion.matches) {
      this.journey = null;
      this.controls.target.copy(target);
      this.camera.position.copy(position);
      this.controls.update();
      return;
    }
    this.journey = {
      fromTarget: this.controls.target.clone(),
      fromPosition: this.camera.position.clone(),
      toTarget: target,
      toPosition: position,
      startMs: null,
    };
    this.controls.dispatchEvent({ type: 'change' });
  }

  turn(azimuthDeg: number, elevationDeg: number, nearer: number): void {
    this.journey = null;
    this.touched = true;
    const offset = this.camera.position.clone().sub(this.controls.target);
    // Spherical measures from +y; the scene's up is z, so the axes are exchanged on the way in and out.
    const place = new Spherical().setFromVector3(new Vector3(offset.y, offset.z, offset.x));
    place.theta += MathUtils.degToRad(azimuthDeg);
    place.phi = MathUtils.clamp(place.phi - MathUtils.degToRad(elevationDeg), HIGHEST_RAD, LOWEST_RAD);
    place.radius = MathUtils.clamp(place.radius / nearer, NEAREST_M, FARTHEST_M);
    const turned = new Vector3().setFromSpherical(place);
    this.camera.position.set(turned.z, turned.x, turned.y).add(this.controls.target);
    this.controls.update();
    this.controls.dispatchEvent({ type: 'change' });
  }

  /** One step of damping or of a journey; true if another has to follow. */
  update(nowMs: number): boolean {
    // Where few pictures are drawn the view comes to rest as soon as elsewhere.
    this.controls.dampingFactor = 1 - (1 - DAMPING) ** Math.max((nowMs - this.lastMs) / REFRESH_MS, 1);
    this.lastMs = nowMs;
    const journey = this.journey;
    if (journey === null) return this.controls.update();
    journey.startMs ??= nowMs;
    const t = Math.min((nowMs - journey.startMs) / RETURN_MS, 1);
    const eased = 1 - (1 - t) ** 3;
    this.controls.target.lerpVectors(journey.fromTarget, journey.toTarget, eased);
    this.camera.position.lerpVectors(journey.fromPosition, journey.toPosition, eased);
    if (t === 1) this.journey = null;
    this.controls.update();
    return true;
  }

  /** What is left of a finger's push would carry the view away from where it is sent. */
  private stopTurning(): void {
    const damped = this.controls.enableDamping;
    this.controls.enableDamping = false;
    this.controls.update();
    this.controls.enableDamping = damped;
  }

  dispose(): void {
    this.controls.dispose();
  }
}
