"""Laws of the supervisor's decisions: storms end, hung processes are found, and nobody is blamed for another's silence."""

from hypothesis import assume, given, settings
from hypothesis import strategies as st

from models.config.site import SupervisorConfig
from services.supervisor.policy import GiveUp, History, Restart, decide
from services.supervisor.silence import BEAT_LIMIT_S, END_LIMIT_S, LIMIT_S, ROUTER_GAP_SHARE, START_LIMIT_S, Silence

CONFIGS = st.builds(SupervisorConfig, max_restarts=st.integers(0, 8), window_s=st.floats(1, 120))
UPTIMES_S = st.lists(st.floats(0, 100), min_size=1, max_size=40)


def live_through(uptimes_s: list[float], config: SupervisorConfig) -> tuple[list[float], bool]:
    """Times of the restarts of a process that runs so long each time, and whether it was given up."""
    history, now_s = History(), 0.0
    for uptime_s in uptimes_s:
        now_s += uptime_s
        decision = decide(history, now_s, config)
        if isinstance(decision, GiveUp):
            return list(history.restarts_s), True
        history, now_s = history.add(decision), decision.at_s
    return list(history.restarts_s), False


@given(UPTIMES_S, CONFIGS)
def test_no_window_holds_more_restarts_than_the_site_file_allows(uptimes_s: list[float], config: SupervisorConfig) -> None:
    restarts_s, _ = live_through(uptimes_s, config)
    for start_s in restarts_s:
        assert sum(start_s <= at_s < start_s + config.window_s * (1 - 1e-9) for at_s in restarts_s) <= config.max_restarts


@given(CONFIGS)
def test_a_process_that_ends_at_once_is_given_up(config: SupervisorConfig) -> None:
    # The longest delay times the number of restarts must fit the window, else it is no storm.
    assume(config.window_s > 4.0 * config.max_restarts)
    restarts_s, given_up = live_through([0.0] * 50, config)
    assert given_up
    assert len(restarts_s) == config.max_restarts


@given(st.lists(st.floats(0, 10), min_size=1, max_size=40), st.integers(1, 8), st.floats(1, 60))
def test_a_process_that_runs_longer_than_the_window_is_never_given_up(
    extra_s: list[float], max_restarts: int, window_s: float
) -> None:
    config = SupervisorConfig(max_restarts=max_restarts, window_s=window_s)
    uptimes_s = [window_s + 0.001 + extra for extra in extra_s]
    restarts_s, given_up = live_through(uptimes_s, config)
    assert not given_up
    assert len(restarts_s) == len(uptimes_s)


@given(UPTIMES_S, CONFIGS)
def test_a_restart_is_never_in_the_past_and_the_first_comes_at_once(uptimes_s: list[float], config: SupervisorConfig) -> None:
    history, now_s = History(), 0.0
    for number, uptime_s in enumerate(uptimes_s):
        now_s += uptime_s
        decision = decide(history, now_s, config)
        if isinstance(decision, Restart):
            assert decision.at_s >= now_s
            assert number > 0 or decision.at_s == now_s
            history, now_s = history.add(decision), decision.at_s


NAMES = ("fusion", "edge-a", "edge-b", "tablet")


def all_started() -> Silence:
    silence = Silence("fusion")
    for name in NAMES:
        silence.start(name, 0.0)
    return silence


def silence_after(lateness_s: dict[str, list[float]], hangs: dict[str, float], end_s: float) -> tuple[dict[str, float], float]:
    """Let all report once a second, somewhat late, until they hang; the time at which each is found, and the end."""
    arrivals = sorted(
        (second + late_s, name)
        for name in NAMES
        for second, late_s in enumerate(lateness_s[name])
        # What the router does not pass on does not arrive either.
        if second + late_s < min(hangs.get(name, end_s), hangs.get("fusion", end_s))
    )
    silence, found, tick_s = all_started(), dict[str, float](), 0.0
    while tick_s < end_s:
        while arrivals and arrivals[0][0] <= tick_s:
            arrived_s, name = arrivals.pop(0)
            silence.hear(name, arrived_s)
        for name in silence.hung(tick_s):
            found.setdefault(name, tick_s)
        tick_s += 0.1
    return found, end_s


LATENESS_S = st.fixed_dictionaries({name: st.lists(st.floats(0, 0.45), min_size=20, max_size=20) for name in NAMES})


@settings(max_examples=30)
@given(LATENESS_S)
def test_nobody_who_reports_is_taken_for_hung(lateness_s: dict[str, list[float]]) -> None:
    found, _ = silence_after(lateness_s, {}, 20.0)
    assert found == {}


@settings(max_examples=30)
@given(LATENESS_S, st.sampled_from(NAMES), st.floats(2, 10))
def test_exactly_the_one_that_hangs_is_found_and_soon(lateness_s: dict[str, list[float]], name: str, at_s: float) -> None:
    found, _ = silence_after(lateness_s, {name: at_s}, 20.0)
    # Also when it is the router, through whose silence nobody else is heard.
    assert set(found) == {name}
    assert LIMIT_S - 1.5 <= found[name] - at_s <= LIMIT_S + 0.2


def test_after_the_router_is_back_the_others_have_time_to_report() -> None:
    silence = all_started()
    for name in NAMES:
        silence.hear(name, 0.0)
    silence.start("fusion", 30.0)
    assert silence.hung(60.0) == []
    silence.hear("fusion", 60.0)
    assert silence.hung(60.0 + ROUTER_GAP_SHARE * LIMIT_S) == []
    for second in range(61, 64):
        silence.hear("fusion", float(second))
    assert set(silence.hung(63.5)) == set(NAMES) - {"fusion"}


def test_a_process_that_is_starting_has_more_time_but_not_for_ever() -> None:
    silence = all_started()
    for second in range(int(START_LIMIT_S) + 1):
        silence.hear("fusion", float(second))
        silence.hear("tablet", float(second))
        silence.hear("edge-b", float(second))
        assert silence.hung(float(second)) == []
    assert silence.hung(START_LIMIT_S + 0.1) == ["edge-a"]


def test_a_router_that_never_comes_has_hung_and_nobody_else() -> None:
    assert all_started().hung(START_LIMIT_S) == []
    assert all_started().hung(START_LIMIT_S + 0.1) == ["fusion"]


def test_a_supervisor_that_was_held_up_blames_nobody() -> None:
    silence = all_started()
    for name in NAMES:
        silence.hear(name, 0.0)
    silence.restart_clocks(100.0)
    assert silence.hung(100.1) == []
    assert silence.hung(100.0 + LIMIT_S + 0.1) == ["fusion"]


BEATING = ("fusion", "tablet")


def beat_lateness_s(most_s: float) -> st.SearchStrategy[dict[str, list[float]]]:
    return st.fixed_dictionaries({name: st.lists(st.floats(0, most_s), min_size=60, max_size=60) for name in BEATING})


def beats_after(lateness_s: dict[str, list[float]], hangs: dict[str, float]) -> dict[str, float]:
    """As `silence_after`, but two of the processes beat five times a second besides, for 12 s."""
    arrivals = [(second + 0.2, name, False) for name in NAMES for second in range(12)]
    arrivals += [(beat / 5 + late_s, name, True) for name in BEATING for beat, late_s in enumerate(lateness_s[name])]
    silence, found, tick_s = all_started(), dict[str, float](), 0.0
    waiting = sorted(one for one in arrivals if one[0] < min(hangs.get(one[1], 99.0), hangs.get("fusion", 99.0)))
    while tick_s < 11.9:
        while waiting and waiting[0][0] <= tick_s:
            arrived_s, name, is_beat = waiting.pop(0)
            (silence.beat if is_beat else silence.hear)(name, arrived_s)
        for name in silence.hung(tick_s):
            found.setdefault(name, tick_s)
            silence.forget(name)
        tick_s += 0.1
    return found


@settings(max_examples=30)
@given(beat_lateness_s(0.8))
def test_nobody_who_beats_is_taken_for_hung(lateness_s: dict[str, list[float]]) -> None:
    assert beats_after(lateness_s, {}) == {}


@settings(max_examples=30)
@given(beat_lateness_s(0.5), st.sampled_from(BEATING), st.floats(2, 8))
def test_who_beats_is_missed_within_little_more_than_the_limit_and_nobody_is_blamed_for_it(
    lateness_s: dict[str, list[float]], name: str, at_s: float
) -> None:
    found = beats_after(lateness_s, {name: at_s})
    assert set(found) == {name}
    assert BEAT_LIMIT_S - 1.1 <= found[name] - at_s <= BEAT_LIMIT_S + 0.2


@given(st.sampled_from(NAMES))
def test_who_said_that_it_ends_has_time_to_leave_and_nobody_is_blamed_for_it(name: str) -> None:
    silence = all_started()
    for each in NAMES:
        silence.beat(each, 0.0)
    silence.last_beat(name, 0.0)
    for tenth in range(1, round(10 * END_LIMIT_S) + 1):
        for each in NAMES:
            # With the router gone from the bus, nobody is heard any more.
            if name not in ("fusion", each):
                silence.beat(each, tenth / 10)
        assert silence.hung(tenth / 10) == []
    assert silence.hung(END_LIMIT_S + 0.1) == [name]
