"""One camera of a running box, judged as the page judges it, in words for a technician. Pure."""

from models.messages.health import Health
from services.doctor.finding import Finding, Level
from services.tablet.camera_state import HeardHealth, camera_status
from services.tablet.messages import CameraReason, CameraStatus
from services.tablet.presence import Presence

_REMEDIES: dict[CameraReason, str] = {
    "no_frames": "check its cable, its power and its file; unplug it and plug it in again",
    "behind": "end other programs on this machine, or lower inference.max_rate_hz in the site file",
    "backlog": "end other programs on this machine, or lower inference.cpu_target in the site file",
    "sparse": "the box is too slow for this many cameras: use fewer, or a faster box",
}
_ELSE = "see what else is found here; if it stays so, start the box anew"
_TOLD: frozenset[CameraReason] = frozenset({"degraded", "ended", "repeats", "clock"})
"""What a camera's process tells with its own words and remedies."""
BUSY_REASONS: frozenset[CameraReason] = frozenset({"behind", "backlog", "sparse"})
"""Slowness that the box causes, not the camera."""


def does_work(name: str, health: Health, now_ns: int) -> bool:
    """Whether a camera delivers pictures, looked at often enough or not."""
    return _status(name, health, now_ns).state in ("ok", "slow")


def is_held_up(name: str, health: Health, now_ns: int) -> bool:
    """Whether a camera is slow for want of CPU."""
    return _status(name, health, now_ns).reason in BUSY_REASONS


def judge_camera(name: str, health: Health, now_ns: int) -> list[Finding]:
    """What is wrong with a camera whose process was just heard; nothing if it works or rests."""
    status = _status(name, health, now_ns)
    if status.state in ("ok", "starting"):
        return []
    level: Level = "fault" if status.state == "lost" else "warning"
    known_by = "what its process measured in the last second"
    where = f"camera '{name}'"
    if status.reason in _TOLD and health.troubles:
        return [Finding(level, where, each.words, "its health on the bus", each.remedy or _ELSE) for each in health.troubles]
    remedy = _REMEDIES.get(status.reason, _ELSE)
    return [Finding(level, where, f"{where} {_words(status, health)}", known_by, remedy)]


def _status(name: str, health: Health, now_ns: int) -> CameraStatus:
    presence = Presence(True, now_ns)
    return camera_status(name, HeardHealth(health, now_ns), presence, given_up=False, used=True, now_ns=now_ns)


def _words(status: CameraStatus, health: Health) -> str:
    rates = f"{status.fresh_hz or 0:.1f} of {status.target_hz or 0:.0f} pictures a second are looked at"
    own = f" ({'; '.join(trouble.words for trouble in health.troubles)})" if health.troubles else ""
    words: dict[CameraReason, str] = {
        "no_frames": "is silent: it delivers no pictures",
        "behind": f"falls behind: {rates}",
        "backlog": f"falls behind: its pictures wait {status.backlog_ms or 0:.0f} ms for their turn",
        "sparse": f"is looked at only {status.fresh_hz or 0:.1f} times a second, too seldom for fast movement",
        "degraded": "works, but how well cannot be known: its figures are none",
    }
    return words.get(status.reason, f"is {status.state}") + own
