import { Group, Mesh, SphereGeometry, Vector3 } from 'three';
import { Level } from '../protocol/attemptReplay';
import { JointState } from '../protocol/motionFrame';
import { Foot, Hand } from './extremities';
import { Head } from './head';
import { judged } from './judged';
import { FOREARM, Limb, SHANK, THIGH, UPPER_ARM, mesh } from './limb';
import { ALONG, BODY, DRAWN, GHOST, GHOST_INSIDE, LEFT, RIGHT, SKIN, VISOR, type Palette } from './materials';
import { Part, lookOf } from './part';
import type { Pose } from './pose';
import { FACE, Joint, TRUNK } from './skeleton';
import { Trunk } from './trunk';

/** Length of trunk, thigh and shank of the body whose radii are given in this folder. */
const REFERENCE_M = 0.48 + 0.42 + 0.41;
const SCALE_LIMITS = [0.5, 1.35] as const;
/** Share of a new measurement in the person's size: limbs must not swell when a joint is off for a moment. */
const SCALE_GAIN = 0.05;

/** The pupil in 3D, made of the 17 joints. World frame: metres, z up. */
export class Figure {
  readonly group = new Group();
  /** Share of the parts that are drawn in colour, of those that can be: 0 when nothing is believed. */
  colouredShare = 0;

  private readonly trunk = new Trunk();
  private readonly head = new Head();
  private readonly limbs = [
    new Limb(Joint.LeftShoulder, Joint.LeftElbow, UPPER_ARM, LEFT),
    new Limb(Joint.RightShoulder, Joint.RightElbow, UPPER_ARM, RIGHT),
    new Limb(Joint.LeftElbow, Joint.LeftWrist, FOREARM, LEFT),
    new Limb(Joint.RightElbow, Joint.RightWrist, FOREARM, RIGHT),
    new Limb(Joint.LeftHip, Joint.LeftKnee, THIGH, LEFT),
    new Limb(Joint.RightHip, Joint.RightKnee, THIGH, RIGHT),
    new Limb(Joint.LeftKnee, Joint.LeftAnkle, SHANK, LEFT),
    new Limb(Joint.RightKnee, Joint.RightAnkle, SHANK, RIGHT),
  ];
  private readonly sockets = [
    new Socket(Joint.LeftShoulder, 0.052, LEFT),
    new Socket(Joint.RightShoulder, 0.052, RIGHT),
    new Socket(Joint.LeftHip, 0.084, BODY),
    new Socket(Joint.RightHip, 0.084, BODY),
  ];
  private readonly hands = [new Hand(Joint.LeftElbow, Joint.LeftWrist), new Hand(Joint.RightElbow, Joint.RightWrist)];
  private readonly feet = [new Foot(Joint.LeftKnee, Joint.LeftAnkle), new Foot(Joint.RightKnee, Joint.RightAnkle)];
  private readonly joints = Array.from({ length: 17 }, () => new Vector3());
  private scale: number | null = null;
  private readonly parts: Part[];
  private readonly insides = new Group();

  constructor() {
    this.group.add(this.trunk.mesh, this.head.skull, this.head.visor, this.head.neck);
    for (const limb of this.limbs) this.group.add(limb.shaft, limb.knob);
    for (const part of [...this.sockets, ...this.hands, ...this.feet]) this.group.add(part.mesh);
    this.parts = this.listParts();
  }

  /** A figure to be shown by `showGhost`, which needs more of each part. */
  static seenThrough(): Figure {
    const figure = new Figure();
    for (const { mesh: part } of figure.parts) {
      const inside = new Mesh(part.geometry, GHOST_INSIDE);
      inside.matrixAutoUpdate = false;
      inside.matrix = part.matrix;
      inside.frustumCulled = false;
      inside.renderOrder = -3;
      part.renderOrder = -2;
      part.castShadow = false;
      figure.insides.add(inside);
    }
    figure.group.add(figure.insides);
    // Whoever is drawn next is before it.
    const last = figure.parts.at(-1)!.mesh;
    last.renderOrder = -1;
    last.onAfterRender = (renderer) => {
      if (figure.insides.visible) renderer.clearDepth();
    };
    return figure;
  }

  /** Another person: the size is measured anew. */
  forgetSize(): void {
    this.scale = null;
  }

  /** Puts the figure into a pose; colour is for what was seen. */
  show(pose: Pose): void {
    this.place(pose);
    this.insides.visible = false;
    for (const part of this.parts) part.mesh.material = part.palette[lookOf(part.state(pose.states))];
    this.count(this.parts, (part) => part.state(pose.states) === JointState.Seen);
  }

  /** Puts the figure into a pose whose joints have 17 levels, from grey to red. */
  showJudged(pose: Pose, levels: Uint8Array): void {
    this.place(pose);
    const coloured = (part: Part): boolean => part.levels(levels).some((level) => level !== Level.Grey);
    for (const part of this.parts) {
      part.judged ??= judged();
      part.judged.levels.fromArray(part.levels(levels));
      part.mesh.material = !part.isJudged && coloured(part) ? ALONG : part.judged.material;
    }
    this.count(
      this.parts.filter((part) => part.isJudged),
      coloured,
    );
  }

  /** Puts the figure into a pose, seen through. */
  showGhost(pose: Pose): void {
    this.place(pose);
    this.insides.visible = true;
    for (const part of this.parts) part.mesh.material = GHOST;
  }

  private place(pose: Pose): void {
    this.joints.forEach((joint, index) => joint.fromArray(pose.positionsM, 3 * index));
    const scale = this.measure();
    const bodyForward = this.placeTrunk(pose, scale);
    for (const limb of this.limbs) limb.place(this.joints[limb.from]!, this.joints[limb.to]!, scale);
    for (const socket of this.sockets) socket.place(this.joints[socket.joint]!, scale);
    for (const hand of this.hands) hand.place(this.joints[hand.elbow]!, this.joints[hand.wrist]!, scale);
    for (const foot of this.feet) foot.place(this.joints[foot.knee]!, this.joints[foot.ankle]!, bodyForward, scale);
  }

  /** Places trunk and head; returns the direction that the body looks in. */
  private placeTrunk(pose: Pose, scale: number): Vector3 {
    const [leftShoulder, rightShoulder, leftHip, rightHip] = TRUNK.map((joint) => this.joints[joint]!) as Four;
    const hips = middle(leftHip, rightHip);
    const shoulders = middle(leftShoulder, rightShoulder);
    const hipHalf = leftHip.clone().sub(rightHip).multiplyScalar(0.5);
    const shoulderHalf = leftShoulder.clone().sub(rightShoulder).multiplyScalar(0.5);
    this.trunk.place({ hips, shoulders, hipHalf, shoulderHalf }, scale);

    const up = shoulders.clone().sub(hips).normalize();
    const left = shoulderHalf.clone().normalize();
    this.head.place(pose, shoulders, up, left, scale);
    return new Vector3().crossVectors(hipHalf, up).normalize();
  }

  private measure(): number {
    const span = (a: number, b: number): number => this.joints[a]!.distanceTo(this.joints[b]!);
    const trunk = 0.5 * (span(Joint.LeftShoulder, Joint.LeftHip) + span(Joint.RightShoulder, Joint.RightHip));
    const thigh = 0.5 * (span(Joint.LeftHip, Joint.LeftKnee) + span(Joint.RightHip, Joint.RightKnee));
    const shank = 0.5 * (span(Joint.LeftKnee, Joint.LeftAnkle) + span(Joint.RightKnee, Joint.RightAnkle));
    const ratio = (trunk + thigh + shank) / REFERENCE_M;
    const measured = Math.min(Math.max(ratio, SCALE_LIMITS[0]), SCALE_LIMITS[1]);
    this.scale = this.scale === null ? measured : this.scale + SCALE_GAIN * (measured - this.scale);
    return this.scale;
  }

  private count(parts: Part[], coloured: (part: Part) => boolean): void {
    this.colouredShare = parts.filter(coloured).length / parts.length;
  }

  private listParts(): Part[] {
    const { skull, visor, neck } = this.head;
    return [
      new Part(this.trunk.mesh, BODY, TRUNK),
      new Part(skull, SKIN, FACE, 'face'),
      new Part(visor, VISOR, FACE, 'face'),
      new Part(neck, SKIN, FACE, 'face'),
      ...this.limbs.flatMap(({ shaft, knob, from, to, palette }) => [
        new Part(shaft, palette, [from, to]),
        new Part(knob, palette, [to]),
      ]),
      ...this.sockets.map(({ mesh, palette, joint }) => new Part(mesh, palette, [joint])),
      ...this.hands.map(({ mesh, elbow, wrist }) => new Part(mesh, DRAWN, [elbow, wrist], 'drawn')),
      ...this.feet.map(({ mesh, knee, ankle }) => new Part(mesh, DRAWN, [knee, ankle], 'drawn')),
    ];
  }
}

/** The round near end of an arm or a leg. */
class Socket {
  readonly mesh: Mesh;

  constructor(
    readonly joint: number,
    private readonly radiusM: number,
    readonly palette: Palette,
  ) {
    this.mesh = mesh(new SphereGeometry(1, 20, 12), palette);
  }

  place(at: Vector3, scale: number): void {
    const radius = this.radiusM * scale;
    this.mesh.matrix.makeScale(radius, radius, radius).setPosition(at);
  }
}

type Four = [Vector3, Vector3, Vector3, Vector3];

function middle(a: Vector3, b: Vector3): Vector3 {
  return a.clone().add(b).multiplyScalar(0.5);
}
