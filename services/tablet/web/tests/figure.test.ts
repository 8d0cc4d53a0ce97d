import { readFileSync } from 'node:fs';
import { Color, Mesh } from 'three';
import { describe, expect, it } from 'vitest';
import { complete, showsSomebody, standing, unsure } from '../src/figure/pose';
import { Figure } from '../src/figure/figure';
import { ALONG, BODY, DRAWN, LEFT, RIGHT, SKIN, VISOR } from '../src/figure/materials';
import { Part } from '../src/figure/part';
import { FACE, Joint, STANDING_M } from '../src/figure/skeleton';
import { Level } from '../src/protocol/attemptReplay';
import { JointState, type MotionFrame } from '../src/protocol/motionFrame';
import { facingRad } from '../src/stage/framing';

function seen(shift = [0, 0, 0]): MotionFrame {
  return {
    kind: 'live',
    sequence: 0,
    epoch: 0,
    tNs: 0n,
    tNewestNs: 0n,
    serverLatencyUs: 0,
    outOfRange: false,
    positionsM: STANDING_M.map((value, i) => value + shift[i % 3]!),
    sigmaMm: new Uint16Array(17),
    states: new Uint8Array(17).fill(JointState.Seen),
    views: new Uint8Array(17),
  };
}

function forget(frame: MotionFrame, ...joints: number[]): void {
  for (const joint of joints) {
    frame.states[joint] = JointState.Unknown;
    frame.positionsM.fill(0, 3 * joint, 3 * joint + 3);
  }
}

describe('a pose', () => {
  it('keeps an unknown arm where it was on the body, and unknown', () => {
    const frame = seen([2, 1, 0.1]);
    forget(frame, Joint.LeftElbow, Joint.LeftWrist);
    const pose = complete(frame, standing());
    const wrist = 3 * Joint.LeftWrist;
    expect(pose.positionsM[wrist]).toBeCloseTo(STANDING_M[wrist]! + 2, 5);
    expect(pose.positionsM[wrist + 2]).toBeCloseTo(STANDING_M[wrist + 2]! + 0.1, 5);
    expect(pose.states[Joint.LeftWrist]).toBe(JointState.Unknown);
  });

  it('carries an unknown hip with the rest of the trunk', () => {
    const frame = seen([0, -3, 0]);
    forget(frame, Joint.RightHip);
    const pose = complete(frame, standing());
    expect(pose.positionsM[3 * Joint.RightHip + 1]).toBeCloseTo(STANDING_M[3 * Joint.RightHip + 1]! - 3, 5);
  });

  it('believes nothing any more when it has become old', () => {
    const pose = unsure(complete(seen(), standing()));
    expect(Math.max(...pose.states)).toBe(JointState.Guessed);
  });

  it('shows nobody without a joint of the trunk', () => {
    const frame = seen();
    expect(showsSomebody(frame)).toBe(true);
    forget(frame, Joint.LeftShoulder, Joint.RightShoulder, Joint.LeftHip, Joint.RightHip);
    expect(showsSomebody(frame)).toBe(false);
  });

  it('looks along +x when it stands', () => {
    expect(facingRad(standing())).toBeCloseTo(0, 5);
  });
});

describe('the figure', () => {
  it('is without colour while nothing is known', () => {
    const figure = new Figure();
    figure.show(standing());
    expect(figure.colouredShare).toBe(0);
  });

  it('is coloured where every joint of a part was seen, and only there', () => {
    const figure = new Figure();
    const pose = complete(seen(), standing());
    figure.show(pose);
    expect(figure.colouredShare).toBe(1);
    pose.states[Joint.LeftKnee] = JointState.Guessed;
    figure.show(pose);
    expect(figure.colouredShare).toBeLessThan(1);
    figure.show(unsure(pose));
    expect(figure.colouredShare).toBe(0);
  });

  it('survives a pose in which everything lies in one point', () => {
    const figure = new Figure();
    figure.show({ positionsM: new Float32Array(51), states: new Uint8Array(17).fill(JointState.Guessed) });
    figure.group.traverse((part) => {
      expect(part.matrix.elements.every(Number.isFinite)).toBe(true);
    });
  });
});

describe('the colours', () => {
  const saturation = (color: Color): number => color.getHSL({ h: 0, s: 0, l: 0 }).s;
  const palettes = Object.entries({ BODY, LEFT, RIGHT, SKIN, VISOR, DRAWN });

  it.each(palettes)('of %s are grey where it is not sure, and only there', (_name, palette) => {
    expect(saturation(palette.seen.color)).toBeGreaterThan(0.5);
    expect(saturation(palette.guessed.color)).toBeLessThan(0.1);
    expect(saturation(palette.unknown.color)).toBeLessThan(0.1);
  });
});

/** Everything that is drawn of a figure. */
function meshes(figure: Figure): Mesh[] {
  const found: Mesh[] = [];
  figure.group.traverse((part) => {
    if (part instanceof Mesh) found.push(part);
  });
  return found;
}

describe('the judged figure', () => {
  const levelsOf = (level: number): Uint8Array => new Uint8Array(17).fill(level);

  it('is without colour where nobody knows', () => {
    const figure = new Figure();
    figure.showJudged(complete(seen(), standing()), levelsOf(Level.Grey));
    expect(figure.colouredShare).toBe(0);
  });

  it('colours all that can be judged, and gives hands and feet no colour that means something', () => {
    const figure = new Figure();
    figure.showJudged(complete(seen(), standing()), levelsOf(Level.Green));
    expect(figure.colouredShare).toBe(1);
    const drawn = meshes(figure).filter((part) => part.material === ALONG);
    expect(drawn).toHaveLength(4);
    expect(ALONG.color.getHSL({ h: 0, s: 0, l: 0 }).s).toBeGreaterThan(0.3); // grey would be "not sure"
  });

  it('leaves a hand as unsure as the wrist that it is drawn from', () => {
    const figure = new Figure();
    const levels = levelsOf(Level.Green);
    levels[Joint.LeftWrist] = Level.Grey;
    levels[Joint.RightElbow] = Level.Grey;
    figure.showJudged(complete(seen(), standing()), levels);
    expect(meshes(figure).filter((part) => part.material === ALONG)).toHaveLength(3);
  });

  it('shows each end of a limb as good as the joint there', () => {
    const levels = levelsOf(Level.Green);
    levels[Joint.LeftKnee] = Level.Red;
    const thigh = new Part(new Mesh(), LEFT, [Joint.LeftHip, Joint.LeftKnee]);
    expect(thigh.levels(levels).slice(0, 2)).toEqual([Level.Green, Level.Red]);
  });

  it('takes a head for as bad as the worst of its points, and for good if two of them are', () => {
    // `tests/unit/test_report_page.py` reads the same table.
    const table = new URL('../../../../tests/golden/head/levels.json', import.meta.url);
    const cases = JSON.parse(readFileSync(table, 'utf-8')) as { points: number[]; head: number }[];
    const head = new Part(new Mesh(), SKIN, FACE, 'face');
    const shown = cases.map(
      ({ points }) => head.levels(Uint8Array.from([...points, ...new Array<number>(12).fill(0)]))[0],
    );
    expect(shown).toEqual(cases.map((each) => each.head));
  });

  it('is blue again when it is live again', () => {
    const figure = new Figure();
    figure.showJudged(complete(seen(), standing()), levelsOf(Level.Red));
    figure.show(unsure(complete(seen(), standing())));
    expect(figure.colouredShare).toBe(0);
  });
});
