"""The twin finds again the law of a network that is known, and tells lessons as fusion needs them told."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from models.errors import UserError
from models.messages.observation import Observation
from tests.twin.agreement import BAR_PCT, Agreement, Case, agree, in_place_of
from tests.twin.bootstrap import Bootstrap
from tests.twin.context import Context, look
from tests.twin.errors import Errors, as_seen
from tests.twin.fit import fit, thinned, to_file
from tests.twin.likeness import GROUPS, Description, describe
from tests.twin.rendered import streams_of as rendered_streams
from tests.twin.stand_in import DELAY_S, StandIn, lesson_of, rendered, streams_of
from tests.twin.twin import Twin

pytestmark = [pytest.mark.slow, pytest.mark.timeout(300)]

LAW = StandIn(swap=0.06, lost=0.06, lasting=2.5)
"""Swaps and losses are frequent and short, so that there are many of them to count."""
CHOICE = ("fifths", 2)


@cache
def _twin() -> Twin:
    return fit([stream for seed in range(6) for stream in streams_of(lesson_of(seed, 12.0), LAW)], choices=(CHOICE,))


@cache
def _small() -> Twin:
    return fit([stream for seed in range(2) for stream in streams_of(lesson_of(seed, 3.0), LAW)], choices=(("thirds", 4),))


@cache
def _beside() -> tuple[Description, Description]:
    """Errors by the law, for long, and by the twin, in situations of lessons that it does not know."""
    told: list[tuple[Context, Errors]] = []
    made: list[tuple[Context, Errors]] = []
    bootstrap = Bootstrap(_twin().library, _twin().settings, 1 / 15)
    for seed in range(10, 18):
        for index, stream in enumerate(streams_of(lesson_of(seed, 10.0), LAW)):
            _, context = look(stream.truth)
            told += [(context, LAW.errors(context, np.random.default_rng((seed, index, again)))) for again in range(4)]
            made += [(context, bootstrap.walker(np.random.default_rng((seed, index, again))).errors(context)) for again in range(2)]
    seen = ([(context, as_seen(context.pose, errors)) for context, errors in streams] for streams in (told, made))
    return describe(next(seen)), describe(next(seen))


@pytest.mark.motions
def test_sizes_of_errors_are_found_again_from_the_median_to_the_tail() -> None:
    """Also of the swapped; where the swapped begin to count, near the 90th percentile, a ratio says nothing."""
    law, twin = _beside()
    for joints in GROUPS.values():
        ratio = twin.quantiles[list(joints)].mean(axis=0) / law.quantiles[list(joints)].mean(axis=0)
        assert ratio[[0, 1, 4]] == pytest.approx(np.ones(3), abs=0.12)


@pytest.mark.motions
def test_errors_remember_as_long_as_they_should() -> None:
    law, twin = _beside()
    assert law.memory.mean(axis=0)[0] == pytest.approx(LAW.memory, abs=0.05)
    assert twin.memory.mean(axis=0) == pytest.approx(law.memory.mean(axis=0), abs=0.05)


@pytest.mark.motions
def test_swaps_and_losses_are_as_frequent_as_they_should_be() -> None:
    law, twin = _beside()
    joints = [7, 8, 9, 10, 13, 14, 15, 16]
    assert twin.crossed[joints].mean() == pytest.approx(law.crossed[joints].mean(), rel=0.3)
    assert twin.lost == pytest.approx(law.lost, rel=0.4)
    assert twin.spell == pytest.approx(law.spell, rel=0.3)


@pytest.mark.motions
def test_scores_know_of_errors_as_much_as_they_should() -> None:
    law, twin = _beside()
    assert twin.knowing == pytest.approx(law.knowing, abs=0.06)
    assert twin.score == pytest.approx(law.score, abs=0.03)


def _cases(network: StandIn) -> list[Case]:
    lessons = [lesson_of(seed, 10.0) for seed in (20, 21)]
    made = [rendered(lesson, network) for lesson in lessons]
    return [Case(seen, lesson.rig.names, events, DELAY_S) for lesson, (seen, events) in zip(lessons, made, strict=True)]


@pytest.mark.motions
def test_fusion_errs_and_jitters_alike_on_the_twin_and_on_what_it_was_fitted_to() -> None:
    agreement = agree(_cases(LAW), lambda _: _twin())
    figures = agreement.figures()
    assert abs(figures["twin.mpjpe_gap_pct"]) < BAR_PCT / 2
    assert abs(figures["twin.jitter_gap_pct"]) < BAR_PCT / 2
    assert agreement.actions == ("walk", "run")


@pytest.mark.motions
def test_a_twin_that_errs_twice_as_much_is_found_out() -> None:
    settings = replace(_twin().settings, gain=tuple(2.0 * gain for gain in _twin().settings.gain))
    figures = agree(_cases(LAW), lambda _: replace(_twin(), settings=settings)).figures()
    assert figures["twin.mpjpe_gap_pct"] > BAR_PCT
    assert figures["twin.jitter_gap_pct"] > BAR_PCT


def test_the_same_lesson_is_told_alike_and_another_seed_otherwise() -> None:
    lesson = lesson_of(5, 2.0)
    told, again, other = (list(_small().observations(each)) for each in (lesson, lesson, replace(lesson, seed=6)))
    assert [repr(one) for one in told] == [repr(one) for one in again]
    assert [repr(one) for one in told] != [repr(one) for one in other]


def test_what_comes_later_in_a_lesson_changes_nothing_before() -> None:
    long, short = lesson_of(5, 5.0), lesson_of(5, 3.0)
    told, begun = (list(_small().observations(each)) for each in (long, short))
    until = min(arrival_s for arrival_s, _ in told[len(begun) :])
    assert [repr(one) for one in told if one[0] < until] == [repr(one) for one in begun if one[0] < until]


def test_observations_come_in_the_order_of_arrival_each_camera_counting_its_own() -> None:
    lesson = lesson_of(5, 4.5)
    told = list(_small().observations(replace(lesson, delays_s=(0.0, 0.3))))
    arrivals = [arrival_s for arrival_s, _ in told]
    assert arrivals == sorted(arrivals)
    for name in lesson.rig.names:
        own = sorted((one for _, one in told if one.camera == name), key=lambda one: one.t_mid_ns)
        assert [one.sequence for one in own] == list(range(len(own)))
    assert len(told) == sum(map(len, lesson.times_s))
    assert any(not one.persons for _, one in told)


def test_nobody_is_found_who_is_out_of_the_picture() -> None:
    lesson = lesson_of(5, 1.0)
    away = replace(
        lesson, rig=replace(lesson.rig, cameras=tuple(replace(c, matrix_px=c.matrix_px + _FAR_ASIDE) for c in lesson.rig))
    )
    assert not any(one.persons for _, one in _small().observations(away))


_FAR_ASIDE = np.array(((0.0, 0.0, 5000.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)))


def test_a_rate_that_was_never_seen_is_refused() -> None:
    with pytest.raises(UserError, match="33 ms apart"):
        next(iter(_small().observations(lesson_of(5, 1.0, rate_hz=30.0))))


def test_the_file_holds_the_twin(tmp_path_factory: pytest.TempPathFactory) -> None:
    path = tmp_path_factory.mktemp("twin") / "twin.npz"
    path.write_bytes(to_file(_small()))
    lesson = lesson_of(5, 1.0)
    assert [repr(one) for one in Twin.load(path).observations(lesson)] == [repr(one) for one in _small().observations(lesson)]
    with pytest.raises(UserError, match="make it with make twin"):
        Twin.load(path.with_name("nothing.npz"))


def test_a_library_that_is_too_large_is_thinned_by_whole_streams_from_all_seeds() -> None:
    streams = [stream for seed in range(3) for stream in streams_of(lesson_of(seed, 2.0), LAW)]
    whole = thinned(streams)
    assert len(whole.seeds) == 12
    small = thinned(streams, len(to_file(Twin(whole, _small().settings))) // 2)
    assert 3 <= len(small.seeds) <= 6
    assert set(small.seeds) == {0, 1, 2}
    with pytest.raises(UserError, match="at least two seeds"):
        fit(streams[:4])


def test_streams_of_a_lesson_are_what_was_said_in_it() -> None:
    lesson = lesson_of(7, 2.0)
    said = streams_of(replace(lesson, pupils=lesson.pupils[:1]), LAW)
    made, events = rendered(lesson, LAW)
    read = rendered_streams(made, lesson.rig.names, events, DELAY_S)
    for one, other in zip(said, read, strict=True):
        assert other.truth.points_m[:, 0] == pytest.approx(one.truth.points_m[:, 0], abs=1e-4)
        assert other.truth.velocity_m_s[1:-1] == pytest.approx(one.truth.velocity_m_s[1:-1], abs=1e-2)
        assert other.said.found.sum() == pytest.approx(one.said.found.sum(), abs=4)


def test_the_twins_words_take_the_place_of_the_networks_picture_by_picture() -> None:
    lesson = lesson_of(7, 1.0)
    _, events = rendered(lesson, LAW)
    words = [(0.0, replace_words(event)) for event in events if isinstance(event, Observation)]
    changed = in_place_of(events, words)
    assert len(changed) == len(events)
    assert all(isinstance(one, Observation) == isinstance(other, Observation) for one, other in zip(events, changed, strict=True))
    assert all(one.network == "twin" for one in changed if isinstance(one, Observation))


def replace_words(event: Observation) -> Observation:
    return Observation(event.camera, 0, event.sequence, event.frame, event.t_mid_ns, 0, "twin", ())


def test_gaps_are_of_the_mean_over_actions() -> None:
    def figures(value: float) -> dict[str, float]:
        return dict.fromkeys(("smooth mpjpe", "live mpjpe", "smooth jitter", "live jitter"), value)

    description = _description()
    agreement = Agreement(
        rendered={("a", "shot"): figures(10.0), ("a", "roll"): figures(30.0), ("b", "shot"): figures(20.0)},
        twin={("a", "shot"): figures(12.0), ("a", "roll"): figures(27.0), ("b", "shot"): figures(24.0)},
        told=description,
        made=description,
    )
    assert agreement.gap_pct("smooth mpjpe", "shot") == pytest.approx(20.0)
    assert agreement.gap_pct("smooth mpjpe", "roll") == pytest.approx(-10.0)
    assert agreement.gap_pct("smooth mpjpe") == pytest.approx(100 * ((18.0 + 27.0) / (15.0 + 30.0) - 1))
    assert agreement.figures()["twin.mpjpe_gap_pct"] == pytest.approx(agreement.gap_pct("live mpjpe"))
    assert [len(table.rows) for table in agreement.tables()] == [3, 7, 7, 7]


def _description() -> Description:
    streams = streams_of(lesson_of(1, 2.0), LAW)
    contexts = [look(stream.truth)[1] for stream in streams]
    return describe([(context, LAW.errors(context, np.random.default_rng(0))) for context in contexts])


def test_the_twin_that_comes_with_kinebox_can_be_loaded() -> None:
    twin = Twin.load()
    assert len(twin.library) > 1000
    assert len(set(twin.library.seeds)) == 5
