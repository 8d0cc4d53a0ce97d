"""The built-in footages, seen by the real networks, recorded and replayed: equal to the last bit, in another process too."""

import hashlib
import subprocess
import sys
from pathlib import Path

import msgspec
import pytest

from edge.footage.sets import FOOTAGES, Footage
from models.camera.rig import decode_rig
from models.messages import codec
from models.messages.motion import Motion
from services.fusion.pipeline import initial_state, step
from services.lesson.lesson_file import LessonWriter
from services.lesson.lesson_reader import open_lesson
from services.lesson.replay import compare, configuration, replay
from tests.bench.footage.run import load_videos, look
from tests.bench.reconstruct.lesson import START_NS
from tests.bench.reconstruct.observed import CONFIG
from tests.installed import ROOT, require_footage, require_networks
from tests.synthetic.gym import Gym
from tests.synthetic.gym_lesson import gym_header
from tests.synthetic.lesson_log import entries, parts

pytestmark = [pytest.mark.slow, pytest.mark.footage, pytest.mark.networks, pytest.mark.timeout(300)]

LIVE_RATE_HZ = 10.0


@pytest.mark.parametrize("footage", FOOTAGES.values(), ids=lambda footage: footage.name)
def test_a_built_in_footage_replays_as_it_was_fused(tmp_path: Path, footage: Footage) -> None:
    data = require_footage(footage)
    require_networks()
    calibration = ROOT / "deploy/sites" / footage.name / "rig.toml"
    rig = decode_rig(calibration.read_bytes(), str(calibration))
    events = look(rig, load_videos(rig, data, footage), data, LIVE_RATE_HZ, network="lightning")

    # Fused here and now, without wire and file between.
    state, total, motions = initial_state(rig), hashlib.sha256(), 0
    for event in events:
        state, output = step(state, event, CONFIG)
        for motion in output.motions:
            motions += 1
            stamped: Motion = msgspec.structs.replace(motion, t_published_ns=0)
            total.update(codec.encode(stamped))
    fused = f"{motions} {total.hexdigest()}"

    writer = LessonWriter.create(tmp_path, "footage", gym_header(Gym(rig=rig), title=footage.name))
    for part in parts(entries(events, rig), START_NS):
        writer.append(part)
    file = writer.finish()
    with open_lesson(file) as lesson:
        found = compare(replay(lesson.parts(), lesson.header.rig(), configuration(lesson.header.preset)))
    assert found.first is None
    assert found.equal == found.compared > 90

    command = [sys.executable, "-m", "tests.integration.replayed_bits", str(file)]
    elsewhere = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, check=True, timeout=200)
    assert elsewhere.stdout.strip() == fused
