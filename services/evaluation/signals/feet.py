"""Where the feet are against one another, as far as ankles tell."""

import numpy as np

from models.arrays import Float
from services.evaluation.signals.posture import Posture
from services.evaluation.signals.signal import Signal


def _uneven(body: Posture) -> Float:
    return 100 * np.abs(body.line("ankle")[..., 2]) / body.stature_m


SIGNALS = (Signal("ankle_uneven", "pct", "How much higher one ankle is than the other, whichever it is.", _uneven),)
