"""2D tracks, and what they say about one common instant (eq. 6's purpose, without frames being paired).

Cameras are not synchronous and run at uneven rates. A track is brought to an instant by interpolation between the
observations around it, or carried a little beyond the newest; sigma grows with what may have happened in between.
"""

import numpy as np

from models.arrays import Bool, Float
from models.skeleton import coco
from services.fusion.compiled import Counts, compiled
from services.fusion.config import TimingConfig
from services.fusion.views import Sighting

SAME_INSTANT_S = 1e-6


class Tracks:
    """The newest sightings of a number of slots, each slot in order of time.

    Attributes:
        times_s: (slots, depth) mid-exposure, oldest first.
        counts: (slots,) how many are filled.
        points_px, sigma_px, usable: (slots, depth, 17, ...) as in `Sighting`.
    """

    def __init__(self, slots: int, depth: int) -> None:
        self.times_s: Float = np.zeros((slots, depth))
        self.counts: Counts = np.zeros(slots, np.int64)
        self.points_px: Float = np.zeros((slots, depth, coco.COUNT, 2))
        self.sigma_px: Float = np.ones((slots, depth, coco.COUNT))
        self.usable: Bool = np.zeros((slots, depth, coco.COUNT), np.bool_)

    def add(self, slot: int, sighting: Sighting) -> bool:
        """Insert at its place in time; False if it is a repetition, or older than all of a full track."""
        count, depth = int(self.counts[slot]), self.times_s.shape[1]
        times = self.times_s[slot, :count]
        place = int(np.searchsorted(times, sighting.t_s))
        if any(abs(times[i] - sighting.t_s) < SAME_INSTANT_S for i in (place - 1, place) if 0 <= i < count):
            return False
        if count == depth:
            if place == 0:
                return False
            place -= 1
            self._move(slot, slice(1, place + 1), slice(0, place))
        else:
            self._move(slot, slice(place, count), slice(place + 1, count + 1))
            self.counts[slot] = count + 1
        self.times_s[slot, place] = sighting.t_s
        self.points_px[slot, place] = sighting.points_px
        self.sigma_px[slot, place] = sighting.sigma_px
        self.usable[slot, place] = sighting.usable
        return True

    def clear(self, slot: int) -> None:
        """Forget a slot's sightings."""
        self.counts[slot] = 0

    def exchange(self, mask: Bool, since_s: float) -> None:
        """Exchange left and right of the flagged joints (17,) in all sightings from an instant on."""
        order = np.where(mask, coco.MIRROR, np.arange(coco.COUNT))
        late = self.times_s >= since_s
        for array in (self.points_px, self.sigma_px, self.usable):
            array[late] = array[late][:, order]

    def newest_s(self, slot: int) -> float:
        """Time of the newest sighting, -inf if there is none."""
        count = int(self.counts[slot])
        return float(self.times_s[slot, count - 1]) if count else -np.inf

    def at(self, t_s: float, config: TimingConfig) -> tuple[Float, Float, Bool]:
        """All slots at one instant: points (slots, 17, 2), sigma (slots, 17), and which of them are known (slots, 17)."""
        return tracks_at(
            t_s,
            self.times_s,
            self.counts,
            self.points_px,
            self.sigma_px,
            self.usable,
            config.acceleration_px_s2,
            config.max_gap_s,
            config.max_ahead_s,
            config.velocity_memory_s,
        )

    def _move(self, slot: int, source: slice, target: slice) -> None:
        for array in (self.times_s, self.points_px, self.sigma_px, self.usable):
            array[slot, target] = array[slot, source].copy()


@compiled
def tracks_at(
    t_s: float,
    times: Float,
    counts: Counts,
    points: Float,
    sigma: Float,
    usable: Bool,
    acceleration: Float,
    max_gap: float,
    max_ahead: float,
    velocity_memory: float,
) -> tuple[Float, Float, Bool]:
    """The kernel of `Tracks.at`: each joint between its own nearest usable sightings."""
    slots, joints = times.shape[0], points.shape[2]
    out = np.zeros((slots, joints, 2))
    out_sigma = np.ones((slots, joints))
    known = np.zeros((slots, joints), np.bool_)
    for slot in range(slots):
        for joint in range(joints):
            before, earlier, after = -1, -1, -1
            for i in range(counts[slot]):
                if not usable[slot, i, joint]:
                    continue
                if times[slot, i] <= t_s:
                    earlier, before = before, i
                else:
                    after = i
                    break
            if before >= 0 and after >= 0 and times[slot, after] - times[slot, before] <= max_gap:
                span = times[slot, after] - times[slot, before]
                share = (t_s - times[slot, before]) / span
                out[slot, joint] = (1.0 - share) * points[slot, before, joint] + share * points[slot, after, joint]
                bend = 0.5 * acceleration[joint] * share * (1.0 - share) * span * span
                a, b = (1.0 - share) * sigma[slot, before, joint], share * sigma[slot, after, joint]
                out_sigma[slot, joint] = np.sqrt(a * a + b * b + bend * bend)
                known[slot, joint] = True
            elif before >= 0 and t_s - times[slot, before] <= max_ahead:
                ahead = t_s - times[slot, before]
                reach = velocity_memory * (1.0 - np.exp(-ahead / velocity_memory))
                bend = 0.5 * acceleration[joint] * ahead * ahead
                noise = sigma[slot, before, joint]
                out[slot, joint] = points[slot, before, joint]
                if earlier >= 0 and times[slot, before] - times[slot, earlier] <= max_gap:
                    span = times[slot, before] - times[slot, earlier]
                    share = reach / span
                    out[slot, joint] += share * (points[slot, before, joint] - points[slot, earlier, joint])
                    a, b = (1.0 + share) * noise, share * sigma[slot, earlier, joint]
                    noise = np.sqrt(a * a + b * b)
                    bend += 0.5 * acceleration[joint] * ahead * span
                else:
                    # Nothing is known of its speed: half a second of the acceleration's sigma stands for it.
                    bend += 0.3 * acceleration[joint] * ahead
                out_sigma[slot, joint] = np.sqrt(noise * noise + bend * bend)
                known[slot, joint] = True
    return out, out_sigma, known
