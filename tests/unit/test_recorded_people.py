"""Real people, recorded by optical markers, replayed: what a force plate and the markers themselves say must hold."""

from functools import cache

import numpy as np
import pytest

from models.arrays import Float
from models.motions.ballistics import GRAVITY_M_S2
from models.motions.figure import Figure
from models.motions.motion import RATE_HZ, Motion
from models.motions.recorded import force, marker_csv, trc
from models.motions.recorded.fit import MarkerFit, fit
from models.motions.recorded.markers import Markers
from models.motions.recorded.replay import motion_of
from models.motions.subject import Subject
from models.skeleton import coco
from models.teaching.standard import FRAME_S
from services.evaluation.search import attempts_in, performances_like
from services.evaluation.track import known_track
from services.support.teaching_files import load_standards
from tests.bodies import body_model, prior_of
from tests.installed import ROOT

SHARED = ROOT.parent / "shared/data"
JUMPS, SERVES = SHARED / "drop_jumps_dev", SHARED / "tennis_serve_dev/markers.csv"
GROWN_UP = 25.0

pytestmark = [pytest.mark.shared_data, pytest.mark.slow]
needs_jumps = pytest.mark.skipif(not JUMPS.is_dir(), reason="the measurement data is not there: drop jumps")
needs_serves = pytest.mark.skipif(not SERVES.is_file(), reason="the measurement data is not there: tennis serves")
NAMES = ("subject4_dj1", "subject4_dj2", "subject4_dj3", "subject5_dj1", "unfiltered_dj1")


@cache
def jump(name: str) -> tuple[Markers, MarkerFit, Motion]:
    markers = trc.decode((JUMPS / f"{name}.trc").read_bytes(), f"{name}.trc")
    found = fit(markers, body_model(), prior_of(body_model()).likely(GROWN_UP))
    return markers, found, motion_of(found)


@cache
def serves() -> tuple[Markers, MarkerFit, Motion]:
    markers = marker_csv.decode(SERVES.read_bytes(), "markers.csv")
    found = fit(markers, body_model(), prior_of(body_model()).likely(GROWN_UP))
    return markers, found, motion_of(found)


def plate(name: str) -> tuple[force.VerticalForce, float, float]:
    recording = force.decode((JUMPS / f"{name}_vertical_force.csv").read_bytes(), f"{name}_vertical_force.csv")
    ((off, on),) = recording.flights_s()
    return recording, off, on


def centre_of_mass_m(found: MarkerFit, motion: Motion) -> Float:
    figure = Figure(Subject(found.body, GROWN_UP, "male"))
    return figure.centres_of_mass_m(figure.place(motion.translations_m, motion.rotations_rad))


@needs_jumps
@pytest.mark.parametrize("name", NAMES)
def test_the_body_is_within_millimetres_of_the_markers_of_a_jump(name: str) -> None:
    found = jump(name)[1]
    assert len(found.names) == 47  # all but the four computed centres of the hips
    assert found.residual_mm < 6.5
    assert np.nanmedian(found.errors_m) < 0.0035
    assert np.nanpercentile(found.errors_m, 99) < 0.025


@needs_jumps
@pytest.mark.parametrize("name", NAMES)
def test_a_jump_falls_with_gravity_and_lasts_as_long_as_the_plate_is_empty(name: str) -> None:
    _, found, motion = jump(name)
    _, off, on = plate(name)
    heights = centre_of_mass_m(found, motion)[:, 2]
    inside = (motion.times_s > off + 0.02) & (motion.times_s < on - 0.02)
    gravity = -2 * np.polyfit(motion.times_s[inside], heights[inside], 2)[0]
    assert gravity == pytest.approx(GRAVITY_M_S2, rel=0.06)
    top = heights[inside].max()
    falls = [top - float(np.interp(at, motion.times_s, heights)) for at in (off, on)]
    flight = sum(np.sqrt(2 * fall / GRAVITY_M_S2) for fall in falls)
    assert flight == pytest.approx(on - off, abs=0.015)


@needs_jumps
@pytest.mark.parametrize("name", NAMES)
def test_feet_bear_before_the_flight_and_not_in_it(name: str) -> None:
    _, _, motion = jump(name)
    _, off, on = plate(name)
    bears = motion.contacts[:, 0] | motion.contacts[:, 1]
    assert bears[: int(0.5 * RATE_HZ)].all()  # on the box
    assert bears[int((off - 0.15) * RATE_HZ) : int((off - 0.05) * RATE_HZ)].all()
    assert not bears[int((off + 0.03) * RATE_HZ) : int((on - 0.03) * RATE_HZ)].any()


@needs_jumps
@pytest.mark.parametrize("name", ["subject4_dj1", "subject5_dj1"])
def test_the_body_weighs_what_its_push_off_tells(name: str) -> None:
    """Impulse over the change of velocity, of a fall from 0.3 m and a flight; a body of average density is no scale, but near."""
    found = jump(name)[1]
    recording, off, on = plate(name)
    first = int(np.flatnonzero(recording.force_n > force.STANDING_N)[0])
    impulse = recording.force_n[first : int(off * recording.rate_hz)].sum() / recording.rate_hz
    change = np.sqrt(2 * GRAVITY_M_S2 * 0.3) + GRAVITY_M_S2 * (on - off) / 2 + GRAVITY_M_S2 * (off - first / recording.rate_hz)
    assert found.body.mass_kg == pytest.approx(impulse / change, rel=0.15)


@needs_serves
def test_the_body_is_within_millimetres_of_the_markers_of_the_serves() -> None:
    found = serves()[1]
    assert len(found.names) == 39
    assert found.residual_mm < 8
    assert np.median(found.errors_m) < 0.004  # some markers of the racket arm are swapped for a tenth of a second


@needs_serves
@pytest.mark.parametrize("near_s", [4.0, 7.6, 11.2])
def test_the_wrist_of_a_serve_is_as_fast_as_its_marker(near_s: float) -> None:
    markers, found, motion = serves()
    place = found.names.index("RWRA")
    near = np.flatnonzero(np.abs(motion.times_s - near_s) < 0.5)
    wrist = np.array([found.body.landmarks_m(motion.pose(int(number)), found.landmarks)[place] for number in near])
    speeds = np.linalg.norm(np.gradient(wrist, 1 / RATE_HZ, axis=0), axis=1)
    measured = np.linalg.norm(np.gradient(markers.of("RWRA"), 1 / markers.rate_hz, axis=0), axis=1)
    peak = measured[np.abs(markers.times_s - near_s) < 0.5].max()
    assert 10 < peak < 11
    assert speeds.max() == pytest.approx(peak, rel=0.15)  # fifty frames a second cut a peak by some percent
    assert motion.times_s[near[int(speeds.argmax())]] == pytest.approx(near_s, abs=0.1)


@needs_serves
def test_three_serves_are_found_with_the_badminton_clear_as_template() -> None:
    """Until the racket hits, a serve is a clear; after it the server falls into the court. So live, where a clear was asked for, it
    is none, and who searches the recording for one finds all three."""
    _, found, motion = serves()
    times_s = np.arange(0, motion.times_s[-1], FRAME_S)
    joints_m = np.stack([found.body.coco_m(motion.pose_at(float(t_s)))[: coco.COUNT] for t_s in times_s])
    track, clear = known_track(joints_m, FRAME_S), load_standards(None)["badminton_clear"]
    like = performances_like(track, clear)
    assert [one.handed for one in like] == ["right"] * 3
    assert [one.moment_s("peak") for one in like] == pytest.approx([4.0, 7.6, 11.2], abs=0.2)
    assert attempts_in(track, clear) == ()
