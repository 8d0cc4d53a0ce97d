"""Reads what is taught at a site."""

from dataclasses import replace
from pathlib import Path
from typing import Final

from models.config.site import Site
from models.messages.feedback import ANY
from models.process import Playback
from services.evaluation.config import VOCABULARY, WHICHEVER, EvaluationConfig
from services.support.teaching_files import load_standards, load_teachings, own_folder

_PLAYED_LATE_FRAMES: Final = 15.0
"""So far beside its time may be what is played: a player that was held up hurries, or lets the time go."""


def configuration(site: Site, data: Path, playback: Playback | None = None) -> EvaluationConfig:
    """What the evaluation of a site goes by.

    Args:
        site: the site file.
        data: the data folder.
        playback: a lesson that is played in the place of a room.

    Raises:
        UserError: what is taught cannot be read, or there is no such activity.
    """
    own = own_folder(data, site.evaluation.teaching)
    activity = ANY if site.evaluation.activity == WHICHEVER else site.evaluation.activity
    config = EvaluationConfig(load_teachings(own, VOCABULARY), load_standards(own), activity)
    return config if playback is None else replace(config, speed=playback.speed, slack_frames=_PLAYED_LATE_FRAMES)
