/** The 17 COCO keypoints, in the order of `models/skeleton/coco.py`; left and right are the person's own. */

export const Joint = {
  Nose: 0,
  LeftEye: 1,
  RightEye: 2,
  LeftEar: 3,
  RightEar: 4,
  LeftShoulder: 5,
  RightShoulder: 6,
  LeftElbow: 7,
  RightElbow: 8,
  LeftWrist: 9,
  RightWrist: 10,
  LeftHip: 11,
  RightHip: 12,
  LeftKnee: 13,
  RightKnee: 14,
  LeftAnkle: 15,
  RightAnkle: 16,
} as const;

export const FACE = [Joint.Nose, Joint.LeftEye, Joint.RightEye, Joint.LeftEar, Joint.RightEar] as const;
export const TRUNK = [Joint.LeftShoulder, Joint.RightShoulder, Joint.LeftHip, Joint.RightHip] as const;

/** A person of 1.70 m who stands at the origin and looks along +x; metres, z up. Shown in grey while there is no data. */
// prettier-ignore
export const STANDING_M = new Float32Array([
   0.11,  0.00, 1.56,
   0.09,  0.03, 1.59,
   0.09, -0.03, 1.59,
   0.01,  0.07, 1.57,
   0.01, -0.07, 1.57,
   0.00,  0.17, 1.38,
   0.00, -0.17, 1.38,
  -0.02,  0.24, 1.11,
  -0.02, -0.24, 1.11,
   0.04,  0.26, 0.87,
   0.04, -0.26, 0.87,
   0.00,  0.10, 0.90,
   0.00, -0.10, 0.90,
   0.02,  0.11, 0.48,
   0.02, -0.11, 0.48,
  -0.02,  0.12, 0.08,
  -0.02, -0.12, 0.08,
]);

/** The joint that each joint hangs on; -1 for the hips and shoulders, which hang on the middle of the known trunk. */
export const PARENT = [5, 0, 0, 0, 0, -1, -1, 5, 6, 7, 8, -1, -1, 11, 12, 13, 14] as const;
