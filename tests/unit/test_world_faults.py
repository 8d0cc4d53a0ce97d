"""What goes wrong in a lesson is by its plan: when it says, as much as it says, and the same in every run."""

import math

import numpy as np
import pytest

from edge.simulation.lesson.cameras import rig_of
from edge.simulation.lesson.plan import BumpPlan, ExposurePlan, LightPlan, ShutterPlan, SwapPlan
from edge.simulation.lesson.world_faults import (
    camera_at,
    delivery_faults,
    exposure_gain,
    light_level,
    phase_s,
    picture_times_s,
    shown_by,
)
from models.config.site import FaultConfig
from tests.lesson_folder import plan_with

FREE = plan_with(shutter=ShutterPlan(phases="free_running"))


def test_synced_shutters_expose_at_once_and_free_running_ones_keep_a_phase_of_their_own() -> None:
    assert phase_s(plan_with(), "cam01") == phase_s(plan_with(), "cam02") == 0.0
    phases = [phase_s(FREE, f"cam0{number}") for number in range(1, 9)]
    assert all(0 <= phase < 1 / 30 for phase in phases)
    assert len(set(phases)) == 8
    assert phases == [phase_s(FREE, f"cam0{number}") for number in range(1, 9)]
    times = picture_times_s(FREE, "cam03", 31)
    assert times[0] == phases[2]
    assert times[30] - times[0] == pytest.approx(1.0, abs=1e-12)


def test_a_camera_that_is_knocked_turns_and_moves_by_exactly_so_much_and_stays_so() -> None:
    plan = plan_with(bumps=[BumpPlan(camera="cam02", at_s=0.5, turn_deg=3.0, move_cm=4.0)])
    before, other = rig_of(plan).cameras[1], rig_of(plan).cameras[0]
    assert camera_at(plan, before, 0.49999) is before
    assert camera_at(plan, other, 0.7) is other
    after = camera_at(plan, before, 0.5)
    cosine = (np.trace(after.rotation @ before.rotation.T) - 1) / 2
    assert math.degrees(math.acos(cosine)) == pytest.approx(3.0, abs=1e-6)
    assert np.linalg.norm(after.centre_m - before.centre_m) == pytest.approx(0.04, abs=1e-9)
    assert np.array_equal(camera_at(plan, before, 0.9).projection, after.projection)


def test_two_knocks_add_up() -> None:
    plan = plan_with(bumps=[BumpPlan(camera="cam01", at_s=at_s, move_cm=10.0) for at_s in (0.2, 0.6)])
    still = rig_of(plan).cameras[0]
    places = [camera_at(plan, still, at_s).centre_m for at_s in (0.1, 0.3, 0.7)]
    steps = np.linalg.norm(np.diff(places, axis=0), axis=1)
    assert steps == pytest.approx([0.1, 0.1])


def test_light_goes_off_and_on_again_at_its_time() -> None:
    plan = plan_with(lights=[LightPlan(at_s=0.2, for_s=0.3, level=0.1)])
    assert [light_level(plan, t_s) for t_s in (0.19, 0.2, 0.49, 0.51)] == [1.0, 0.1, 0.1, 1.0]


def test_an_exposure_changes_evenly_in_stops_and_stays() -> None:
    plan = plan_with(exposures=[ExposurePlan(camera="cam01", at_s=0.2, stops=-2.0, over_s=0.4)])
    assert [exposure_gain(plan, "cam01", t_s) for t_s in (0.2, 0.4, 0.6, 9.0)] == pytest.approx([1.0, 0.5, 0.25, 0.25])
    assert exposure_gain(plan, "cam02", 0.6) == 1.0


def test_cameras_that_swap_names_show_one_anothers_pictures_from_then_on_and_a_second_swap_undoes_it() -> None:
    plan = plan_with(swaps=[SwapPlan(cameras=("cam01", "cam03"), at_s=at_s) for at_s in (0.3, 0.6)])
    assert [shown_by(plan, "cam01", t_s) for t_s in (0.2, 0.3, 0.6)] == ["cam01", "cam03", "cam01"]
    assert [shown_by(plan, "cam03", t_s) for t_s in (0.2, 0.3, 0.6)] == ["cam03", "cam01", "cam03"]
    assert shown_by(plan, "cam02", 0.5) == "cam02"


@pytest.mark.parametrize("first", ["cam01", "cam02"])
def test_whatever_is_swapped_every_camera_is_shown_under_exactly_one_name(first: str) -> None:
    pairs = [(first, "cam03"), ("cam03", "cam04"), ("cam02", "cam04")]
    plan = plan_with(swaps=[SwapPlan(cameras=pair, at_s=0.1 * number) for number, pair in enumerate(pairs)])
    for t_s in (0.0, 0.15, 0.25):
        assert len({shown_by(plan, f"cam0{number}", t_s) for number in range(1, 5)}) == 4


def test_a_fault_of_a_lesson_comes_again_with_every_lesson_and_never_reaches_into_the_next() -> None:
    def fault(**more: float) -> FaultConfig:
        return FaultConfig(camera="cam01", kind="stall", **more)

    plan = plan_with(faults=[fault(at_s=0.4, for_s=99.0), fault(at_s=0.1, for_s=0.05, every_s=0.3)])
    played = delivery_faults(plan, "cam01", 1.0)
    assert [(each.at_s, each.for_s) for each in played] == [
        pytest.approx(pair) for pair in [(0.4, 0.6), (0.1, 0.05), (0.4, 0.05), (0.7, 0.05)]
    ]
    assert {each.every_s for each in played} == {1.0}
    assert delivery_faults(plan, "cam02", 1.0) == []
