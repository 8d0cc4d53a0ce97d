"""Everyone whom the cameras see, until the pupil is chosen among them."""

from collections.abc import Iterable

import numpy as np

from models.compiled import Counts
from services.fusion.timing import Tracks
from services.fusion.views import Sighting

PERSONS = 6
"""Tracks that are kept of one camera."""
_DEPTH = 24


class Candidates:
    """Recent sightings by camera and by the track that the camera's edge process gave them.

    Attributes:
        tracks: slot camera * PERSONS + i holds one person of one camera.
        identities: (cameras, PERSONS) the track's number at the edge, -1 where empty.
    """

    def __init__(self, cameras: int) -> None:
        self.tracks = Tracks(cameras * PERSONS, _DEPTH)
        self.identities: Counts = np.full((cameras, PERSONS), -1, np.int64)

    def add(self, sighting: Sighting) -> int:
        """Take a sighting into its track, and return its slot; a new track replaces the one that was seen longest ago."""
        row = self.identities[sighting.camera]
        base = sighting.camera * PERSONS
        numbers = row.tolist()
        if sighting.track in numbers:
            slot = base + int(numbers.index(sighting.track))
        else:
            newest = [self.tracks.newest_s(base + i) for i in range(PERSONS)]
            slot = base + int(np.argmin(newest))
            self.tracks.clear(slot)
            row[slot - base] = sighting.track
        self.tracks.add(slot, sighting)
        return slot

    def live(self, t_s: float, max_age_s: float) -> list[int]:
        """Slots that were still seen within `max_age_s` before `t_s`, or later."""
        return [slot for slot in range(self.identities.size) if t_s - self.tracks.newest_s(slot) <= max_age_s]

    def identity(self, slot: int) -> tuple[int, int]:
        """(camera index, track number) of a slot."""
        return slot // PERSONS, int(self.identities[slot // PERSONS, slot % PERSONS])

    def since(self, slots: Iterable[int], t_s: float) -> list[Sighting]:
        """All sightings of these slots from `t_s` on, in order of time."""
        found = []
        for slot in slots:
            tracks, camera_and_track = self.tracks, self.identity(slot)
            for i in np.flatnonzero(tracks.times_s[slot, : tracks.counts[slot]] >= t_s):
                arrays = tracks.points_px[slot, i].copy(), tracks.sigma_px[slot, i].copy(), tracks.usable[slot, i].copy()
                found.append(Sighting(*camera_and_track, float(tracks.times_s[slot, i]), *arrays))
        return sorted(found, key=lambda sighting: sighting.t_s)
