"""What is wrong with a process, a camera or the machine: a code for programs, words and what to do for people."""

from typing import Literal, get_args

import msgspec

MachineCode = Literal["disk_full", "disk_low", "memory_low", "hot", "throttled", "clock_set"]
MACHINE_CODES: tuple[MachineCode, ...] = get_args(MachineCode)
"""The worst first."""
SourceCode = Literal["camera_ended", "camera_repeats", "camera_clock"]
SOURCE_CODES: tuple[SourceCode, ...] = get_args(SourceCode)
"""Why nothing that a camera sends can be used: each is the cause where the camera seems to be silent."""
CameraCode = Literal[SourceCode, "camera_silent", "camera_dark", "pictures_damaged", "network_missing", "plans_refused"]
CalibrationCode = Literal["cameras_exchanged", "cameras_disagree", "camera_moved"]
CALIBRATION_CODES: tuple[CalibrationCode, ...] = get_args(CalibrationCode)
"""What the cameras see is not what the calibration says."""
FusionCode = Literal["camera_unheard", "pictures_not_fused", "epochs_differ"]
EvaluationCode = Literal["motion_missed"]
TabletCode = Literal["words_unreadable"]
RecorderCode = Literal["not_recording", "recording_stalled"]
SupervisorCode = Literal["given_up", "restarting", "log_not_kept", "machine_unmeasured"]
TroubleCode = Literal[
    "getting_ready",
    "messages_refused",
    MachineCode,
    CameraCode,
    CalibrationCode,
    FusionCode,
    EvaluationCode,
    TabletCode,
    RecorderCode,
    SupervisorCode,
]
"""By which programs, and tests, know a trouble. Words may be changed at any time, a code only with the wire format's version."""


class Trouble(msgspec.Struct, frozen=True):
    """One thing that is wrong.

    Attributes:
        code: what it is.
        words: what it is, for people, with its figures; without what to do.
        remedy: what to do; empty where it mends itself, or where the words are another's that have it in them.
    """

    code: TroubleCode
    words: str
    remedy: str = ""


def one_line(troubles: tuple[Trouble, ...]) -> str:
    """Words and remedies of all, for people; nothing may be read out of it again."""
    return "; ".join(filter(None, (part for trouble in troubles for part in (trouble.words, trouble.remedy))))


def messages_refused(count: int) -> Trouble:
    """So many messages could not be read since the last word."""
    words = f"{count} messages could not be read in the last second"
    return Trouble("messages_refused", words, "look for a process of another version or a program that writes on the bus; end it")
