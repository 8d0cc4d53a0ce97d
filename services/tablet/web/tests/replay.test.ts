import { describe, expect, it } from 'vitest';
import { FACE, Joint, STANDING_M } from '../src/figure/skeleton';
import { JOINT_COUNT, JointState } from '../src/protocol/motionFrame';
import { Level, type AttemptReplay } from '../src/protocol/attemptReplay';
import { Player } from '../src/replay/player';
import { hasStandard, mirrored, momentAt, moved, whole } from '../src/replay/scene';
import { facingRad } from '../src/stage/framing';

/** Somebody who stands, and is half a metre further with each frame. */
function walk(frames = 4): AttemptReplay {
  const positionsM = new Float32Array(frames * 3 * JOINT_COUNT);
  for (let i = 0; i < positionsM.length; i++) {
    const frame = Math.floor(i / (3 * JOINT_COUNT));
    positionsM[i] = STANDING_M[i % (3 * JOINT_COUNT)]! + (i % 3 === 0 ? 0.5 * frame : 0);
  }
  return {
    frames,
    frameS: 0.1,
    keyframes: [0, 1, 2, 3],
    positionsM,
    states: new Uint8Array(frames * JOINT_COUNT).fill(JointState.Seen),
    levels: new Uint8Array(frames * JOINT_COUNT).fill(Level.Green),
    standardM: positionsM.slice(),
    standardStates: new Uint8Array(frames * JOINT_COUNT).fill(JointState.Seen),
  };
}

/** The standard is not known there. */
function forget(replay: AttemptReplay, frame: number, ...joints: number[]): void {
  for (const joint of joints) {
    const place = frame * JOINT_COUNT + joint;
    replay.standardM.fill(NaN, 3 * place, 3 * place + 3);
    replay.standardStates[place] = JointState.Unknown;
  }
}

describe('the player', () => {
  it('plays slowly, rests at the end, and begins anew', () => {
    const player = new Player(2, [0, 0.5, 1, 2]);
    player.speed = 0.25;
    for (let i = 0; i < 79; i++) player.advance(0.1);
    expect(player.positionS).toBeCloseTo(1.975, 5);
    player.advance(0.11);
    expect(player.positionS).toBe(2);
    expect(player.advance(0.5)).toBe(false);
    expect(player.positionS).toBe(2);
    player.advance(0.5);
    expect(player.positionS).toBe(0);
    expect(player.rounds).toBe(1);
  });

  it('stays where it is put, within the attempt', () => {
    const player = new Player(2, [0, 0.5, 1, 2]);
    player.seek(1.2);
    expect(player.playing).toBe(false);
    expect(player.advance(5)).toBe(false);
    expect(player.positionS).toBe(1.2);
    player.seek(9);
    expect(player.positionS).toBe(2);
    player.seekKeyframe(1);
    expect(player.positionS).toBe(0.5);
  });

  it('begins anew when it is started at its end', () => {
    const player = new Player(2, [0, 0.5, 1, 2]);
    player.seek(2);
    player.toggle();
    expect(player.positionS).toBe(0);
    expect(player.playing).toBe(true);
  });
});

describe('a moment of an attempt', () => {
  it('lies between two frames in slow motion', () => {
    const { pose, standard } = momentAt(walk(), 0.125);
    expect(pose.positionsM[0]).toBeCloseTo(STANDING_M[0]! + 0.625, 5);
    expect(standard?.positionsM[0]).toBeCloseTo(STANDING_M[0]! + 0.625, 5);
  });

  it('never has a colour or a state that no frame has', () => {
    const replay = walk();
    replay.levels.fill(Level.Red, JOINT_COUNT, 2 * JOINT_COUNT);
    replay.levels.fill(Level.Grey, 0, JOINT_COUNT);
    for (const at of [0, 0.03, 0.049, 0.051, 0.08]) {
      expect([Level.Grey, Level.Red]).toContain(momentAt(replay, at).levels[0]);
    }
  });

  it('is that of the ends beyond them', () => {
    const replay = walk();
    expect(momentAt(replay, 99).pose.positionsM[0]).toBeCloseTo(STANDING_M[0]! + 1.5, 5);
    expect(momentAt(replay, -1).pose.positionsM[0]).toBeCloseTo(STANDING_M[0]!, 5);
  });

  it('shows a standard that has no face, as imported ones may, with a head that is not known', () => {
    const replay = walk();
    for (let frame = 0; frame < replay.frames; frame++) forget(replay, frame, ...FACE);
    const shown = whole(replay);
    expect(hasStandard(shown)).toBe(true);
    for (const at of [0, 0.12, 0.3]) {
      const { standard } = momentAt(shown, at);
      expect(standard?.positionsM.every(Number.isFinite)).toBe(true);
      expect(standard?.states[Joint.Nose]).toBe(JointState.Unknown);
      expect(standard?.states[Joint.LeftKnee]).toBe(JointState.Seen);
    }
  });

  it('keeps a knee of the standard that is missing for a while on its hip, and unknown', () => {
    const replay = walk();
    forget(replay, 2, Joint.LeftKnee);
    const { standard } = momentAt(whole(replay), 0.2);
    expect(standard?.positionsM[3 * Joint.LeftKnee]).toBeCloseTo(STANDING_M[3 * Joint.LeftKnee]! + 1, 5);
    expect(standard?.states[Joint.LeftKnee]).toBe(JointState.Unknown);
  });

  it('has a standard in some frame or in none, whatever the first one is like', () => {
    const [late, never] = [walk(), walk()];
    forget(late, 0, ...Object.values(Joint));
    for (let frame = 0; frame < never.frames; frame++) forget(never, frame, ...Object.values(Joint));
    expect([whole(late), whole(never)].map(hasStandard)).toEqual([true, false]);
    expect(momentAt(whole(late), 0).standard).toBeNull();
    expect(momentAt(whole(late), 0.1).standard).not.toBeNull();
    expect(momentAt(whole(never), 0.1).standard).toBeNull();
  });

  it('keeps an unknown wrist on its arm, and unknown', () => {
    const replay = walk();
    const wrist = 2 * JOINT_COUNT + Joint.LeftWrist;
    replay.states[wrist] = JointState.Unknown;
    replay.positionsM.fill(0, 3 * wrist, 3 * wrist + 3);
    const { pose } = momentAt(whole(replay), 0.2);
    expect(pose.positionsM[3 * Joint.LeftWrist]).toBeCloseTo(STANDING_M[3 * Joint.LeftWrist]! + 1, 5);
    expect(pose.states[Joint.LeftWrist]).toBe(JointState.Unknown);
  });
});

describe('a mirror', () => {
  const mirror = { at: [0.3, -0.2], across: [0.6, 0.8] } as const;
  const moment = momentAt(walk(), 0.1);

  it('makes a left arm of a right one, with its colour', () => {
    const own = { ...moment, levels: moment.levels.slice() };
    own.levels[Joint.RightWrist] = Level.Red;
    const seen = mirrored(own, mirror);
    expect(seen.levels[Joint.LeftWrist]).toBe(Level.Red);
    expect(seen.levels[Joint.RightWrist]).toBe(Level.Green);
  });

  it('is where it was when it is turned over twice', () => {
    const twice = mirrored(mirrored(moment, mirror), mirror);
    moment.pose.positionsM.forEach((value, i) => expect(twice.pose.positionsM[i]).toBeCloseTo(value, 5));
  });

  it('leaves a body whose left is still on the left of where it looks', () => {
    // Who looks along x and is mirrored in a plane along x looks along x.
    const along = mirrored(moment, { at: [0, 0], across: [0, 1] });
    expect(facingRad(along.pose)).toBeCloseTo(facingRad(moment.pose), 5);
    expect(Math.abs(facingRad(mirrored(moment, { at: [0, 0], across: [1, 0] }).pose))).toBeCloseTo(Math.PI, 5);
  });

  it('moves along without changing the pose', () => {
    const { positionsM } = moved(moment.pose, [1, -2]);
    expect(positionsM[0]! - moment.pose.positionsM[0]!).toBeCloseTo(1, 5);
    expect(positionsM[1]! - moment.pose.positionsM[1]!).toBeCloseTo(-2, 5);
    expect(positionsM[2]).toBe(moment.pose.positionsM[2]);
  });
});
