"""The parametric body: a person's shape and pose give joints, landmarks and skin.

Frame of the body: metres, x to the front, y to the left, z up, the pelvis at the origin. At pose zero the person stands in
the T-pose, arms along y, palms down, and looks along x. With the pelvis' rotation and translation the body stands in the
world, whose z is up, too: no turn of axes lies between. (SMPL's own frame has y up and z to the front; a rotation vector
(x, y, z) of SMPL is (z, x, y) here.)

The body follows SMPL: Loper et al., "SMPL: A Skinned Multi-Person Linear Model", ACM Trans. Graphics 34(6), 2015.
"""

from typing import Final

SMALL: Final = "data/body_2500.npz"
"""The body with about 2,500 vertices, inside this package; made by `models.body.build.export`."""
LARGE: Final = "data/body_6000.npz"
"""The same people with about 6,000 vertices: the same shape coefficients and poses, the same joints."""
