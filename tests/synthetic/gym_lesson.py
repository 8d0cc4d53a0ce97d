"""A lesson file of a synthetic gym, made without a clock: as fusion and the recorder would have left it."""

import sys
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from models.camera.rig import encode_rig
from models.config.site import SITE_VERSION, CameraConfig, Site
from models.messages import codec
from models.messages.health import CameraHealth, EvaluationHealth, FusionHealth, Health
from models.messages.lesson import Entry
from models.messages.pupil import NOBODY, PupilTurn
from models.messages.trouble import Trouble
from services.lesson import origin
from services.lesson.lesson_file import LessonWriter
from services.lesson.lesson_header import LessonHeader
from services.site_file.rendering import render
from services.support.version import kinebox_version
from tests.synthetic.gym import T0_NS, Gym
from tests.synthetic.lesson_log import entries, parts

SECOND_NS = 1_000_000_000
WALL_S = 1_795_000_000
TITLE = "7b, throwing"


def gym_header(gym: Gym, title: str = TITLE, machine: str = "", kinebox: str = "") -> LessonHeader:
    """Of a lesson in a gym, recorded by this KineBox on this machine unless told otherwise."""
    cameras = [CameraConfig(name=name, kind="video", path="none.avi") for name in gym.rig.names]
    site = Site(version=SITE_VERSION, name="Synthetic gym", calibration="rig.toml", cameras=cameras)
    return LessonHeader(
        title=title,
        kinebox=kinebox or kinebox_version(),
        machine=machine or origin.machine(),
        preset=site.fusion.preset,
        site_toml=render(site),
        rig_toml=encode_rig(gym.rig, "synthetic").decode(),
        started_ns=T0_NS,
        wall_minus_monotonic_ns=WALL_S * SECOND_NS - T0_NS,
        run_ns=T0_NS,
    )


def with_health(log: Iterable[Entry], gym: Gym, turns: Sequence[PupilTurn] = ()) -> Iterator[Entry]:
    """The log with what cameras, fusion and the evaluation say of themselves once a second, and who was up."""
    due_ns = 0
    for entry in log:
        if entry.kind == "tick" and entry.t_ns >= due_ns:
            due_ns = entry.t_ns + SECOND_NS
            for health in _healths(gym, entry.t_ns, [turn for turn in turns if turn.t_ns <= entry.t_ns]):
                yield Entry("health", entry.t_ns, codec.encode(health))
        yield entry


def write_gym_lesson(
    folder: Path, gym: Gym, header: LessonHeader | None = None, name: str = "lesson", turns: Sequence[PupilTurn] = ()
) -> Path:
    """Record a whole gym as one segment; the finished file."""
    writer = LessonWriter.create(folder, name, header or gym_header(gym))
    for part in parts(with_health(entries(gym.events(), gym.rig), gym, turns), T0_NS):
        writer.append(part)
    return writer.finish()


def _healths(gym: Gym, t_ns: int, turns: Sequence[PupilTurn]) -> Iterator[Health]:
    for name in gym.rig.names:
        rates = CameraHealth(name, 30.0, 14.0, 15.0, 0, 20.0, "thunder", {})
        yield Health(f"edge-{name}", 4000, t_ns, "ok", (), 0.3, 200.0, camera=rates)
    yield Health("fusion", 4001, t_ns, "ok", (), 0.2, 150.0, fusion=FusionHealth(30.0, 4.0, 0.5, 0, {}, "found"))
    up = turns[-1] if turns else PupilTurn(NOBODY, 0)
    evaluation = EvaluationHealth("long_jump", "tablet", "waiting", 3, 0.2, 30.0, 0, 0, up.pupil, up.t_ns)
    yield Health("evaluation", 4003, t_ns, "ok", (), 0.2, 150.0, evaluation=evaluation)
    yield Health("tablet", 4002, t_ns, "failed", (Trouble("given_up", "of another day"),), 0.2, 150.0)


if __name__ == "__main__":
    write_gym_lesson(Path(sys.argv[1]), Gym(seconds=float(sys.argv[2])))
