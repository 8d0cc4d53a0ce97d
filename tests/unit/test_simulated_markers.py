"""Markers on moving bodies are seen in the picture where truth says they are: within half a pixel, for every rig and lens."""

from functools import cache

import numpy as np
import pytest

from edge.simulation.picture.lens import lens_of
from edge.simulation.picture.renderer import Renderer
from edge.simulation.picture.scene import Pupil, Scene
from edge.simulation.picture.shutter import Shutter
from edge.simulation.rigs.arrangements import NAMES, make_rig
from edge.simulation.truth.witness import Witness
from models.arrays import Float
from models.camera.pinhole import Camera
from models.motions.actions.library import ACTIONS
from models.motions.perform import perform
from models.motions.performance import Performance
from models.motions.subject import Subject
from models.skeleton.coco_feet import INDEX
from tests.bodies import body_model, someone
from tests.installed import require_graphics
from tests.synthetic.markers import RADIUS_M, centroids_px, in_the_dark
from tests.synthetic.moving_scene import Flinger, Moved, look_at

WITHIN_PX = 0.25
BLURRED_WITHIN_PX = 0.5
"""Of streaks of up to 60 px."""
POINTS = tuple(
    INDEX[name]
    for name in (
        "nose",
        "left_elbow",
        "right_elbow",
        "left_wrist",
        "right_wrist",
        "left_knee",
        "right_knee",
        "left_heel",
        "right_heel",
    )
)
SHUTTERS = {
    "rolling": Shutter(exposure_s=0.004, readout_s=0.03),
    "blurred": Shutter(exposure_s=1 / 60, readout_s=0.016),
    "global": Shutter(exposure_s=0.002, readout_s=0.0),
}
LENSES = {
    "none": (0.0, 0.0, 0.0, 0.0, 0.0),
    "barrel": (-0.32, 0.11, 0.002, -0.0015, -0.01),
    "pincushion": (0.15, 0.05, -0.003, 0.002, 0.02),
    "moustache": (-0.25, 0.3, 0.0, 0.0, -0.05),
}


@cache
def flinger() -> Flinger:
    model = body_model()
    return Flinger(model.shaped(someone(model, 1)), "A", (0.0, 0.0), (0.5, 0.5, 0.5))


@cache
def renderer() -> Renderer:
    require_graphics()
    return Renderer(in_the_dark(flinger(), POINTS))


def errors_px(drawn: Renderer, pupil: Pupil, camera: Camera, shutter: Shutter, times_s: list[float]) -> Float:
    """Distances between markers in the picture and truth; only of those that are seen apart from others.

    A long exposure shows the mean over its time, which for a point that turns is not where it is in the middle of it.
    """
    view = drawn.view(camera, shutter)
    witness = Witness(Scene((), (pupil,), (), ()), lens_of(camera), shutter)
    apart = []
    # Of a marker, as far away as the nearest may be, with its smooth edge.
    radius_px = 2.5 + RADIUS_M * camera.matrix_px[0, 0] / (np.linalg.norm(camera.centre_m - pupil.joints_m(times_s[0])[0]) - 0.5)
    for t_s in times_s:
        long = shutter.exposure_s > 0.01
        within = t_s + (np.linspace(-0.5, 0.5, 41)[1::2] * shutter.exposure_s if long else np.zeros(1))
        expected = np.stack([witness.take_down(when).coco_px[0, 0][list(POINTS)] for when in within]).astype(np.float64).mean(0)
        found = centroids_px(view.picture(t_s), expected, *((30, 24) if long else (12, round(radius_px))))
        apart.append(np.linalg.norm(found - expected, axis=1))
    every = np.concatenate(apart)
    return np.asarray(every[np.isfinite(every)])


@pytest.mark.slow
@pytest.mark.parametrize("shutter", SHUTTERS)
@pytest.mark.parametrize("lens", LENSES)
def test_markers_are_where_truth_says_for_every_lens_and_shutter(lens: str, shutter: str) -> None:
    camera = look_at((-3.1, -1.6, 1.7), focal_px=1050, size_px=(1280, 720), distortion=LENSES[lens])
    apart = errors_px(renderer(), flinger(), camera, SHUTTERS[shutter], [0.05 + 0.07 * number for number in range(6)])
    assert len(apart) > 25
    assert apart.max() < (BLURRED_WITHIN_PX if shutter == "blurred" else WITHIN_PX)


@pytest.mark.slow
@pytest.mark.parametrize("rig", NAMES)
def test_markers_are_where_truth_says_in_every_camera_of_every_rig(rig: str) -> None:
    for camera in make_rig(rig, "test", 3):
        apart = errors_px(renderer(), flinger(), camera, SHUTTERS["rolling"], [0.12, 0.29])
        assert len(apart) > 7, camera.name
        assert apart.max() < WITHIN_PX, camera.name


@pytest.mark.slow
def test_without_the_rolling_rows_markers_would_not_be_there() -> None:
    camera = look_at((-3.1, -1.6, 1.7), focal_px=1050, size_px=(1280, 720))
    view = renderer().view(camera, SHUTTERS["rolling"])
    still = Witness(Scene((), (flinger(),), (), ()), lens_of(camera), SHUTTERS["global"])
    apart = []
    for t_s in (0.05, 0.12, 0.19, 0.26):
        expected = still.take_down(t_s).coco_px[0, 0][list(POINTS)].astype(np.float64)
        apart.append(np.linalg.norm(centroids_px(view.picture(t_s), expected, 16, 8) - expected, axis=1))
    assert np.nanmax(np.concatenate(apart)) > 4


@pytest.mark.slow
@pytest.mark.parametrize("action", ACTIONS)
def test_markers_are_where_truth_says_in_every_action(action: str) -> None:
    require_graphics()
    model = body_model()
    body = model.shaped(someone(model, 5))
    motion = perform(Performance(action), Subject(body, 14.0, "male"))
    (attempt,) = motion.attempts
    pupil = Moved(body, motion)
    drawn = Renderer(in_the_dark(pupil, POINTS))
    shares = (-0.3, -0.2, -0.1, -0.05, -0.02, 0.0, 0.03, 0.06, 0.1, 0.15, 0.2, 0.3)
    times_s = [attempt.peak_s + share * (attempt.end_s - attempt.start_s) for share in shares]
    found = [errors_px(drawn, pupil, camera, SHUTTERS["rolling"], times_s) for camera in make_rig("corners", "test", 5).cameras[:3]]
    assert sum(len(apart) for apart in found) > 20
    assert np.concatenate(found).max() < WITHIN_PX


@pytest.mark.slow
def test_no_outline_is_brighter_than_what_it_is_the_outline_of() -> None:
    view = renderer().view(look_at((-6.0, -3.0, 1.7), focal_px=1050, size_px=(1280, 720)), SHUTTERS["rolling"])
    brightest = [float(view.picture(0.05 * number).max()) for number in range(40)]
    assert max(brightest) < 1.01  # A marker's light from above, which is its most.
