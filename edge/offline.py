"""Every picture of a video through the edge's step, without a clock: for benches and for calibration from footage."""

import time
from collections.abc import Callable
from dataclasses import replace

from edge.cameras.video import Video
from edge.observe import EdgeConfig, EdgeState, Networks, Stages, observe
from edge.turns import default_control
from models.messages.observation import Observation


def observe_video(
    video: Video,
    networks: Networks,
    rate_hz: float,
    config: EdgeConfig | None = None,
    stages: Stages | None = None,
    shown: Callable[[int], None] = lambda _: None,
) -> list[Observation]:
    """Observe all pictures, looking at everybody in each of them.

    Args:
        video: loaded by `load_video`.
        networks: what to run.
        rate_hz: pictures a second, by which `t_mid_ns` counts from 0.
        config: settings; the default ones if None. People are never looked at in turns here.
        stages: takes the CPU time, if somebody wants to know.
        shown: is told the number of each picture when it is done.
    """
    config = config or EdgeConfig()
    tracking = replace(config.tracking, looks_max=config.tracking.people_max)
    config = replace(config, tracking=tracking)
    stages = stages or Stages(time.process_time_ns)
    control = default_control(video.camera, 0, 1, 0, rate_hz)
    state, observations = EdgeState(), []
    for frame in video.frames(rate_hz):
        state, observation = observe(state, frame, networks, control, config, stages)
        observations.append(observation)
        shown(frame.index)
    return observations
