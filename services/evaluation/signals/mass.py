"""Which share each COCO point has in the centre of mass.

The paper takes the mean of the joints (`JOINT_MEAN`). That puts the centre of a standing child some 6 cm too high, for
five of 17 points are in the face. The default weighs segments by their masses at the pupil's age, as `models.body.masses` has
them; the age is told by the stature where nobody tells it.
"""

from typing import Final

import numpy as np

from models.arrays import Float
from models.body.masses import coco_shares
from models.skeleton import coco

COM_SOURCE: Final = "segment masses by age: Jensen, J. Biomechanics 19, 1986 and 22, 1989; de Leva, J. Biomechanics 29, 1996"
JOINT_MEAN: Final = np.full(coco.COUNT, 1 / coco.COUNT)
"""The paper's centre of mass."""
_STATURES_M: Final = (1.16, 1.28, 1.38, 1.50, 1.62, 1.70)
_YEARS: Final = (6.0, 8.0, 10.0, 12.0, 14.0, 20.0)
"""Median statures of girls and boys: WHO growth reference 5-19 years, de Onis et al., Bulletin WHO 85(9), 2007."""


def masses_of(stature_m: float) -> Float:
    """(17,) shares for somebody of this height, by the age at which half of all pupils are so tall; NaN is a grown-up."""
    return coco_shares(float(np.interp(stature_m if np.isfinite(stature_m) else _STATURES_M[-1], _STATURES_M, _YEARS)))
