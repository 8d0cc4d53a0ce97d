"""2D tracks, and what they say about one common instant (eq. 6's purpose, without frames being paired).

Cameras are not synchronous and run at uneven rates. A track is brought to an instant by interpolation between the
observations around it, or carried a little beyond the newest; sigma grows with what may have happened in between.
"""

import numpy as np

from models.arrays import Bool, Float
from models.compiled import Counts, compiled
from models.skeleton import coco
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
        inserted: bool = insert(
            self.times_s[slot],
            self.counts,
            slot,
            self.points_px[slot],
            self.sigma_px[slot],
            self.usable[slot],
            sighting.t_s,
            sighting.points_px,
            sighting.sigma_px,
            sighting.usable,
        )
        return inserted

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


@compiled
def insert(
    times: Float,
    counts: Counts,
    slot: int,
    points: Float,
    sigma: Float,
    usable: Bool,
    t_s: float,
    new_points: Float,
    new_sigma: Float,
    new_usable: Bool,
) -> bool:
    """The kernel of `Tracks.add`: arrays of one slot, in place."""
    count, depth = counts[slot], times.shape[0]
    place = count
    while place > 0 and times[place - 1] > t_s:
        place -= 1
    if (place > 0 and t_s - times[place - 1] < SAME_INSTANT_S) or (place < count and times[place] - t_s < SAME_INSTANT_S):
        return False
    if count == depth:
        if place == 0:
            return False
        place -= 1
        for i in range(place):
            times[i], points[i], sigma[i], usable[i] = times[i + 1], points[i + 1], sigma[i + 1], usable[i + 1]
    else:
        for i in range(count, place, -1):
            times[i], points[i], sigma[i], usable[i] = times[i - 1], points[i - 1], sigma[i - 1], usable[i - 1]
        counts[slot] = count + 1
    times[place], points[place], sigma[place], usable[place] = t_s, new_points, new_sigma, new_usable
    return True


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
