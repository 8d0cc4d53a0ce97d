"""Cameras that die, people who are not the pupil, seams, and messages that make no sense."""

from dataclasses import replace

import msgspec
import numpy as np
import pytest

from models.messages.motion import JointState
from models.messages.observation import Observation
from models.skeleton import coco
from services.fusion.config import PRESETS
from services.fusion.pipeline import Tick, initial_state, predict_views, step
from tests.synthetic.gym import T0_NS, Gym, ring_rig
from tests.synthetic.person import Person
from tests.synthetic.play import DEFAULT, after, errors_mm, play

pytestmark = pytest.mark.slow
GYM = Gym(seconds=5.0)


def test_one_dead_camera_costs_accuracy_and_nothing_else() -> None:
    gym = replace(GYM, dead=((1, 1.5, 9.0),))
    played = play(gym.rig, gym.events())
    late = after(played.smooth, 2.5)
    assert np.nanmean(errors_mm(late, gym.truth)) < 30.0
    assert np.mean([motion.states == JointState.SEEN for motion in late]) > 0.97
    assert not any(motion.cameras[1].used for motion in late)
    assert all(motion.cameras[1].age_ms > 800 for motion in after(played.live, 3.0))


def test_two_dead_cameras_still_leave_a_figure() -> None:
    gym = replace(GYM.quiet(), dead=((1, 1.5, 9.0), (3, 1.5, 9.0)), rig=ring_rig(4, height_m=2.6))
    late = after(play(gym.rig, gym.events()).smooth, 2.5)
    assert np.nanmedian(errors_mm(late, gym.truth)) < 60.0


def test_when_all_cameras_are_dead_the_figure_goes_grey_within_a_second_and_comes_back() -> None:
    gym = replace(GYM, dead=tuple((camera, 2.0, 3.5) for camera in range(4)))
    live = play(gym.rig, gym.events()).live
    assert all((motion.states == JointState.UNKNOWN).all() for motion in after(live, 2.9, 3.4))
    back = after(live, 4.3)
    assert np.mean([motion.states == JointState.SEEN for motion in back]) > 0.97
    assert np.nanmean(errors_mm(back, gym.truth)) < 45.0


def test_a_pupil_who_leaves_is_let_go_and_the_next_one_is_chosen_at_once() -> None:
    following = Person(centre_m=(0.8, -0.6), radius_m=0.3, phase=0.4)
    gym = replace(GYM.quiet(), bystanders=((following, (0, 1, 2, 3)),))

    def present(event: Observation) -> Observation:
        seconds = (event.t_mid_ns - T0_NS) * 1e-9
        track = 1 if seconds < 2.0 else 10 if seconds > 3.0 else None
        return msgspec.structs.replace(event, persons=tuple(person for person in event.persons if person.track == track))

    played = play(gym.rig, [event if isinstance(event, Tick) else present(event) for event in gym.events()])
    found = {round(tick / 30, 3): output.found for tick, output in enumerate(out for out in played.outputs if out.searching)}
    assert not any(value for seconds, value in found.items() if 2.8 < seconds < 3.0), "nobody is there, and the pupil is held"
    assert all(value for seconds, value in found.items() if seconds > 3.6)
    late = after(played.live, 3.7)
    assert np.nanmean(errors_mm(late, lambda t_ns: following.joints((t_ns - T0_NS) * 1e-9))) < 45.0


def test_joints_that_nobody_confirms_stay_bounded() -> None:
    gym = replace(GYM, dead=tuple((camera, 2.0, 9.0) for camera in range(4)))
    error = errors_mm(after(play(gym.rig, gym.events()).live, 2.0), gym.truth)
    assert np.nanmax(error) < 1200.0


def test_a_bystander_in_two_views_is_never_fused() -> None:
    bystander = Person(height_m=1.75, centre_m=(1.9, -0.3), radius_m=0.1, throws=False, phase=0.3)
    gym = replace(GYM, bystanders=((bystander, (0, 1)),))
    played = play(gym.rig, gym.events())
    for motions in (played.live, played.smooth):
        middle = after(motions, 1.0)
        assert np.nanmean(errors_mm(middle, gym.truth)) < 45.0
    assert played.outputs[-1].found


def test_a_bystander_who_is_listed_first_is_not_chosen() -> None:
    bystander = Person(height_m=1.75, centre_m=(1.9, -0.3), radius_m=0.1, throws=False, phase=0.3)
    gym = replace(GYM, seconds=2.0, bystanders=((bystander, (0, 1)),))
    events = [
        event if isinstance(event, Tick) else msgspec.structs.replace(event, persons=event.persons[::-1]) for event in gym.events()
    ]
    assert np.nanmean(errors_mm(after(play(gym.rig, events).smooth, 0.5), gym.truth)) < 40.0


@pytest.mark.parametrize("seed", range(3))
def test_a_view_in_which_the_network_mixes_two_people_is_not_fused(seed: int) -> None:
    """Somebody stands before the pupil in one view: most keypoints there are on the wrong one, a few on the right."""
    gym = replace(GYM, rates_hz=(15.0,), seed=seed).quiet()
    camera, name = 2, gym.rig.names[2]
    aside = 0.19 * gym.rig.cameras[camera].rotation[0]
    mixed = [joint for joint in range(coco.COUNT) if joint not in (13, 14, 15, 16)]

    def mix(event: Observation) -> Observation:
        if event.camera != name or (event.t_mid_ns - T0_NS) * 1e-9 < 2.0:
            return event
        points = event.persons[0].keypoints_px.copy()
        points[mixed] = gym.rig.cameras[camera].project(gym.truth(event.t_mid_ns) + aside)[mixed]
        return msgspec.structs.replace(event, persons=(msgspec.structs.replace(event.persons[0], keypoints_px=points),))

    played = play(gym.rig, [event if isinstance(event, Tick) else mix(event) for event in gym.events()])
    late = after(played.smooth, 2.5)
    assert np.mean([motion.cameras[camera].used for motion in late]) < 0.25
    assert np.nanmean(errors_mm(late, gym.truth)) < 35.0


def test_a_camera_whose_crop_drifted_to_a_neighbour_is_not_fused_and_is_asked_to_search() -> None:
    neighbour = Person(centre_m=(0.0, 2.2), radius_m=0.1, throws=False)
    gym = replace(GYM, bystanders=((neighbour, (2,)),))

    def drift(event: Observation | Tick) -> Observation | Tick:
        if isinstance(event, Tick) or event.camera != "cam2" or not 2.0 < (event.t_mid_ns - T0_NS) * 1e-9 < 3.5:
            return event
        wrong = event.persons[1]
        return msgspec.structs.replace(event, persons=(msgspec.structs.replace(wrong, track=event.persons[0].track),))

    played = play(gym.rig, [drift(event) for event in gym.events()])
    assert np.nanmean(errors_mm(after(played.smooth, 1.0), gym.truth)) < 30.0
    drifted = [out for out in played.outputs if out.motions and 2.6 < (out.motions[0].t_ns - T0_NS) * 1e-9 < 3.3]
    assert drifted
    assert all(out.searching["cam2"] for out in drifted)
    assert not played.outputs[-1].searching.get("cam2", False)


def test_a_pose_within_ten_frames() -> None:
    gym = replace(GYM, seconds=2.0)
    first = next(m for m in play(gym.rig, gym.events()).smooth if (m.states == JointState.SEEN).sum() >= 15)
    assert (first.t_ns - T0_NS) * 1e-9 < 0.3


def _looped(gym: Gym) -> list[Observation | Tick]:
    """The gym's footage twice: the second time as epoch 1, the person jumping back to where he or she started."""
    first, shift_ns = gym.events(), round(gym.seconds * 1e9)
    second: list[Observation | Tick] = []
    for event in first:
        if isinstance(event, Tick):
            second.append(Tick(event.t_ns + shift_ns))
        else:
            second.append(msgspec.structs.replace(event, epoch=1, t_mid_ns=event.t_mid_ns + shift_ns))
    return first + second


def test_a_seam_leaves_no_hole_and_carries_nothing_over() -> None:
    gym = replace(GYM, seconds=3.0)
    played = play(gym.rig, _looped(gym))

    def truth(t_ns: int) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
        return gym.truth(T0_NS + (t_ns - T0_NS) % round(gym.seconds * 1e9))

    for motions in (played.live, played.smooth):
        around = after(motions, 2.5, 3.9)
        gaps = np.diff([motion.t_ns for motion in around])
        assert (gaps > 0).all()
        assert gaps.max() < 36e6
        assert np.nanmax(errors_mm(after(motions, 2.7, 2.95), truth)) < 400.0
        assert np.nanmean(errors_mm(after(motions, 3.6, 4.5), truth)) < 45.0
        epochs = [motion.epoch for motion in motions]
        assert epochs == sorted(epochs)
        assert set(epochs) == {0, 1}


def test_late_words_of_a_past_epoch_are_ignored_and_counted() -> None:
    gym = replace(GYM, seconds=2.0)
    events = _looped(gym)
    late = next(event for event in events if isinstance(event, Observation))
    played = play(gym.rig, [*events, late])
    assert played.state is not None
    assert sum(played.state.ignored.values()) >= 1


def test_words_that_make_no_sense_change_nothing() -> None:
    gym = replace(GYM, seconds=2.0)
    events = gym.events()
    clean = play(gym.rig, events)
    sample = next(event for event in events if isinstance(event, Observation))
    dirty: list[Observation | Tick] = []
    for event in events:
        dirty.append(event)
        if isinstance(event, Observation):
            dirty.append(event)
            dirty.append(msgspec.structs.replace(event, camera="nobody"))
            dirty.append(msgspec.structs.replace(sample, t_mid_ns=event.t_mid_ns + 10**12))
        else:
            dirty.append(Tick(event.t_ns - 5_000_000))
    played = play(gym.rig, dirty)
    assert len(played.live) == len(clean.live)
    for ours, theirs in zip(played.live, clean.live, strict=True):
        np.testing.assert_array_equal(ours.joints_m, theirs.joints_m)


def test_vanishing_sigmas_full_scores_and_empty_pictures_do_no_harm() -> None:
    gym = replace(GYM, seconds=2.0)
    events: list[Observation | Tick] = []
    for number, event in enumerate(gym.events()):
        if isinstance(event, Observation):
            persons = tuple(msgspec.structs.replace(p, sigma_px=np.full(coco.COUNT, 1e-30, np.float32)) for p in event.persons)
            event = msgspec.structs.replace(event, persons=() if number % 7 == 0 else persons)  # noqa: PLW2901
        events.append(event)
    live = play(gym.rig, events).live
    for motion in live:
        assert np.isfinite(motion.joints_m).all()
        assert np.isfinite(motion.covariance_m2).all()
    assert (live[-1].states == JointState.SEEN).sum() >= 9, "the pupil is still found"


def test_predicted_crops_hold_the_pupil() -> None:
    gym = replace(GYM, seconds=3.0, rig=ring_rig(4, distorted=True))
    state = initial_state(gym.rig)
    assert set(predict_views(state, T0_NS).values()) == {None}
    inside = []
    for event in gym.events():
        state, _ = step(state, event, DEFAULT)
        if isinstance(event, Tick) and event.t_ns > T0_NS + 1_000_000_000:
            for name, prediction in predict_views(state, event.t_ns).items():
                assert prediction is not None
                pixels = gym.rig.cameras[gym.rig.index(name)].project(gym.truth(event.t_ns + 40_000_000))
                place = prediction.at(event.t_ns + 40_000_000).to_crop(pixels)
                inside.append(((place > 0) & (place < 1)).all(axis=1).mean())
                extent = np.ptp(pixels, axis=0).max()
                assert prediction.crop.side_px < 2.0 * extent
    assert np.mean(inside) > 0.98


def test_the_paper_preset_runs() -> None:
    gym = replace(GYM, seconds=2.0)
    played = play(gym.rig, gym.events(), PRESETS["paper"])
    assert np.nanmean(errors_mm(after(played.smooth, 1.0), gym.truth)) < 80.0
