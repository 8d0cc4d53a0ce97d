import { BufferAttribute, BufferGeometry, Vector3, type Mesh } from 'three';
import { share } from './judged';
import { mesh } from './limb';
import { BODY } from './materials';

/**
 * Cross-sections of the trunk from the seat to the neck. `along` is 0 at the line of the hips and 1 at that of the shoulders;
 * half width is `hips` of the hip line plus `shoulders` of the shoulder line plus `widthM`; metres are those of a body of 1.70 m.
 */
const SECTIONS = [
  { along: -0.2, hips: 0.2, shoulders: 0, widthM: 0.02, depthM: 0.04, forwardM: 0 },
  { along: -0.16, hips: 0.6, shoulders: 0, widthM: 0.035, depthM: 0.078, forwardM: -0.005 },
  { along: -0.02, hips: 0.9, shoulders: 0, widthM: 0.065, depthM: 0.104, forwardM: -0.012 },
  { along: 0.14, hips: 0.9, shoulders: 0, widthM: 0.06, depthM: 0.1, forwardM: -0.005 },
  { along: 0.38, hips: 0.5, shoulders: 0.2, widthM: 0.042, depthM: 0.084, forwardM: 0.006 },
  { along: 0.68, hips: 0.15, shoulders: 0.75, widthM: 0.005, depthM: 0.103, forwardM: 0.008 },
  { along: 0.88, hips: 0, shoulders: 1, widthM: -0.006, depthM: 0.09, forwardM: 0 },
  { along: 0.99, hips: 0, shoulders: 0.92, widthM: 0.005, depthM: 0.068, forwardM: -0.006 },
  { along: 1.06, hips: 0, shoulders: 0.58, widthM: 0.005, depthM: 0.054, forwardM: -0.008 },
  { along: 1.11, hips: 0, shoulders: 0.2, widthM: 0.028, depthM: 0.046, forwardM: -0.006 },
] as const;

const AROUND = 32;
const RINGS = 30;
/** 2 would be an ellipse; a little more makes the trunk squarer, as trunks are. */
const SQUARENESS = 2.35;

/** The frame of the trunk, in metres, world. */
export interface TrunkFrame {
  hips: Vector3;
  shoulders: Vector3;
  /** Half of the hip line and of the shoulder line, from the person's right to the left. */
  hipHalf: Vector3;
  shoulderHalf: Vector3;
}

/** The trunk as one volume, lofted anew between hips and shoulders for every pose, twist included. */
export class Trunk {
  readonly mesh: Mesh;
  private readonly positions = new Float32Array(3 * (AROUND * (RINGS + 1) + 2));
  private readonly geometry = new BufferGeometry();

  constructor() {
    this.geometry.setAttribute('position', new BufferAttribute(this.positions, 3));
    this.geometry.setIndex(faces());
    share(this.geometry, sharesAt);
    this.mesh = mesh(this.geometry, BODY);
  }

  place(frame: TrunkFrame, scale: number): void {
    // Its own origin is between the hips, as a pattern on it moves along with that.
    this.mesh.matrix.setPosition(frame.hips);
    const centre = new Vector3();
    for (let ring = 0; ring <= RINGS; ring++) {
      const section = sectionAt(ring / RINGS);
      this.ring(ring, frame, section, scale, centre);
      if (ring === 0) this.write(AROUND * (RINGS + 1), centre);
    }
    this.write(AROUND * (RINGS + 1) + 1, centre);
    const position = this.geometry.getAttribute('position');
    position.needsUpdate = true;
    this.geometry.computeVertexNormals();
  }

  private ring(ring: number, frame: TrunkFrame, section: Section, scale: number, centre: Vector3): void {
    const t = Math.min(Math.max(section.along, 0), 1);
    const across = new Vector3().lerpVectors(frame.hipHalf, frame.shoulderHalf, t).normalize();
    const up = new Vector3().subVectors(frame.shoulders, frame.hips);
    const forward = new Vector3().crossVectors(across, up).normalize();
    const halfWidth =
      section.hips * frame.hipHalf.length() + section.shoulders * frame.shoulderHalf.length() + section.widthM * scale;
    const halfDepth = section.depthM * scale;
    centre
      .set(0, 0, 0)
      .addScaledVector(up, section.along)
      .addScaledVector(forward, section.forwardM * scale);
    const point = new Vector3();
    for (let step = 0; step < AROUND; step++) {
      const angle = (2 * Math.PI * step) / AROUND;
      const [c, s] = [squared(Math.cos(angle)), squared(Math.sin(angle))];
      point
        .copy(centre)
        .addScaledVector(across, c * halfWidth)
        .addScaledVector(forward, s * halfDepth);
      this.write(ring * AROUND + step, point);
    }
  }

  private write(vertex: number, point: Vector3): void {
    this.positions[3 * vertex] = point.x;
    this.positions[3 * vertex + 1] = point.y;
    this.positions[3 * vertex + 2] = point.z;
  }
}

/** How much a point belongs to the left shoulder, the right shoulder, the left hip and the right hip. */
function sharesAt(vertex: number): [number, number, number, number] {
  const ring = Math.min(Math.floor(vertex / AROUND), RINGS);
  const upper = Math.min(Math.max(sectionAt(ring / RINGS).along, 0), 1);
  const left = vertex < AROUND * (RINGS + 1) ? 0.5 + 0.5 * Math.cos((2 * Math.PI * (vertex % AROUND)) / AROUND) : 0.5;
  return [upper * left, upper * (1 - left), (1 - upper) * left, (1 - upper) * (1 - left)];
}

type Section = { [Key in keyof (typeof SECTIONS)[number]]: number };

function squared(value: number): number {
  return Math.sign(value) * Math.abs(value) ** (2 / SQUARENESS);
}

/** Catmull-Rom interpolation of the sections at `t` in [0, 1]. */
function sectionAt(t: number): Section {
  const place = t * (SECTIONS.length - 1);
  const i = Math.min(Math.floor(place), SECTIONS.length - 2);
  const u = place - i;
  const at = (k: number): Section => SECTIONS[Math.min(Math.max(k, 0), SECTIONS.length - 1)]!;
  const [a, b, c, d] = [at(i - 1), at(i), at(i + 1), at(i + 2)];
  const blend = (key: keyof Section): number =>
    b[key] +
    0.5 *
      u *
      (c[key] -
        a[key] +
        u * (2 * a[key] - 5 * b[key] + 4 * c[key] - d[key] + u * (3 * (b[key] - c[key]) + d[key] - a[key])));
  return {
    along: blend('along'),
    hips: blend('hips'),
    shoulders: blend('shoulders'),
    widthM: blend('widthM'),
    depthM: blend('depthM'),
    forwardM: blend('forwardM'),
  };
}

function faces(): number[] {
  const index: number[] = [];
  const [bottom, top] = [AROUND * (RINGS + 1), AROUND * (RINGS + 1) + 1];
  for (let step = 0; step < AROUND; step++) {
    const next = (step + 1) % AROUND;
    for (let ring = 0; ring < RINGS; ring++) {
      const [a, b] = [ring * AROUND + step, ring * AROUND + next];
      index.push(a, b + AROUND, b, a, a + AROUND, b + AROUND);
    }
    index.push(bottom, step, next, top, RINGS * AROUND + next, RINGS * AROUND + step);
  }
  return index;
}
