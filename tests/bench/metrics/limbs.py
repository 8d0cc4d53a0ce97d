"""Whether limbs keep their length."""

import numpy as np

from models.arrays import Float
from models.skeleton import coco


def limb_variation_pct(joints_m: Float) -> dict[str, float]:
    """Standard deviation over mean of each limb's length over time, percent; (frames, 17, 3), NaN frames left out."""
    variation = {}
    for limb, (proximal, distal) in coco.LIMBS.items():
        length = np.linalg.norm(joints_m[:, proximal] - joints_m[:, distal], axis=-1)
        length = length[np.isfinite(length)]
        variation[limb] = float(100 * length.std() / length.mean()) if len(length) > 1 else float("nan")
    return variation
