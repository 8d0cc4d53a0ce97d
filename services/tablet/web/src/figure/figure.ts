import { Group, SphereGeometry, Vector3, type Mesh } from 'three';
import { JointState } from '../protocol/motionFrame';
import { Foot, Hand } from './extremities';
import { Head } from './head';
import { FOREARM, Limb, SHANK, THIGH, UPPER_ARM, mesh } from './limb';
import { BODY, DRAWN, LEFT, RIGHT, SKIN, VISOR, type Palette } from './materials';
import type { Pose } from './pose';
import { FACE, Joint, TRUNK } from './skeleton';
import { Trunk } from './trunk';

/** Length of trunk, thigh and shank of the body whose radii are given in this folder. */
const REFERENCE_M = 0.48 + 0.42 + 0.41;
const SCALE_LIMITS = [0.5, 1.35] as const;
/** Share of a new measurement in the person's size: limbs must not swell when a joint is off for a moment. */
const SCALE_GAIN = 0.05;
/** So many points of the face make a head seen. */
const FACE_QUORUM = 2;

/** The pupil in 3D, made of the 17 joints. World frame: metres, z up. */
export class Figure {
  readonly group = new Group();
  /** Share of the parts that are drawn in colour: 0 when nothing is believed. */
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
  private parts = 0;
  private coloured = 0;

  constructor() {
    this.group.add(this.trunk.mesh, this.head.skull, this.head.visor, this.head.neck);
    for (const limb of this.limbs) this.group.add(limb.shaft, limb.knob);
    for (const part of [...this.sockets, ...this.hands, ...this.feet]) this.group.add(part.mesh);
  }

  /** Another person: the size is measured anew. */
  forgetSize(): void {
    this.scale = null;
  }

  /** Puts the figure into a pose. */
  show(pose: Pose): void {
    this.joints.forEach((joint, index) => joint.fromArray(pose.positionsM, 3 * index));
    const scale = this.measure();
    const bodyForward = this.placeTrunk(pose, scale);
    for (const limb of this.limbs) limb.place(this.joints[limb.from]!, this.joints[limb.to]!, scale);
    for (const socket of this.sockets) socket.place(this.joints[socket.joint]!, scale);
    for (const hand of this.hands) hand.place(this.joints[hand.elbow]!, this.joints[hand.wrist]!, scale);
    for (const foot of this.feet) foot.place(this.joints[foot.knee]!, this.joints[foot.ankle]!, bodyForward, scale);
    this.colour(pose.states);
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

  private colour(states: Uint8Array): void {
    this.parts = 0;
    this.coloured = 0;
    const worst = (...joints: number[]): number => Math.min(...joints.map((joint) => states[joint]!));
    this.paint(worst(...TRUNK), [this.trunk.mesh, BODY]);
    const face = FACE.map((joint) => states[joint]!).sort((a, b) => b - a)[FACE_QUORUM - 1]!;
    this.paint(face, [this.head.skull, SKIN], [this.head.visor, VISOR], [this.head.neck, SKIN]);
    for (const limb of this.limbs) {
      this.paint(worst(limb.from, limb.to), [limb.shaft, limb.palette], [limb.knob, limb.palette]);
    }
    for (const socket of this.sockets) this.paint(states[socket.joint]!, [socket.mesh, socket.palette]);
    for (const hand of this.hands) this.paint(worst(hand.elbow, hand.wrist), [hand.mesh, DRAWN]);
    for (const foot of this.feet) this.paint(worst(foot.knee, foot.ankle), [foot.mesh, DRAWN]);
    this.colouredShare = this.coloured / this.parts;
  }

  private paint(state: number, ...meshes: [Mesh, Palette][]): void {
    this.parts += 1;
    if (state === JointState.Seen) this.coloured += 1;
    const look = state === JointState.Seen ? 'seen' : state === JointState.Guessed ? 'guessed' : 'unknown';
    for (const [part, palette] of meshes) part.material = palette[look];
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
