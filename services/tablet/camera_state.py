"""How a camera is, from what its process says and when it last said it."""

import math
from dataclasses import dataclass

from models.messages.health import CameraHealth, Health
from models.messages.trouble import TroubleCode
from services.tablet.messages import CameraReason, CameraState, CameraStatus
from services.tablet.presence import Presence

START_GRACE_NS = 20_000_000_000
"""So long may a process be starting after it, or this server, came: networks are loaded."""
SILENT_AFTER_NS = 3_000_000_000
"""A process says how it is every second; three missed are no accident."""
BEHIND_SHARE = 0.7
"""Below this share of the inferences asked for, a camera is slow."""
SPARSE_HZ = 8.0
"""Below so many inferences a second, fast movement (a throw lasts 0.3 s) falls between the pictures."""
BACKLOG_MS = 250.0
"""A frame older than this when its turn came shows a figure that visibly trails."""

_CAUSES: dict[TroubleCode, CameraReason] = {"camera_ended": "ended", "camera_repeats": "repeats", "camera_clock": "clock"}
"""What a process may know of why its camera shows nothing."""
_GIVEN_UP: tuple[CameraState, CameraReason] = ("lost", "given_up")


@dataclass(frozen=True)
class HeardHealth:
    """A process's newest health and the CLOCK_MONOTONIC of its arrival."""

    health: Health
    arrived_ns: int


def known(figure: float) -> float | None:
    """A figure from the bus; None if it is none (NaN or infinite), which JSON could not carry."""
    return figure if math.isfinite(figure) else None


def camera_status(
    name: str, heard: HeardHealth | None, presence: Presence, *, given_up: bool, used: bool, now_ns: int
) -> CameraStatus:
    """Judge one camera.

    Args:
        name: the camera.
        heard: its process's newest health; None if there was none since the process came.
        presence: its process on the bus.
        given_up: the supervisor does not start its process any more.
        used: the newest motion rests on it too.
        now_ns: CLOCK_MONOTONIC.
    """
    state, reason = _GIVEN_UP if given_up else _judge(heard, presence, now_ns)
    camera = heard.health.camera if heard else None
    here = state not in ("lost", "unknown")
    measured = camera if here else None  # the last figures of a lost camera would look like life
    return CameraStatus(
        name=name,
        state=state,
        reason=reason,
        detail=heard.health.reason if heard else "",
        source_hz=known(measured.source_hz) if measured else None,
        fresh_hz=known(measured.fresh_hz) if measured else None,
        target_hz=known(measured.target_hz) if measured else None,
        network=measured.network if measured else None,
        backlog_ms=known(measured.backlog_ms) if measured else None,
        skipped=camera.skipped if camera else None,
        used=used and here,
    )


def _judge(heard: HeardHealth | None, presence: Presence, now_ns: int) -> tuple[CameraState, CameraReason]:
    if heard is not None and heard.health.state == "failed":
        return "lost", "failed"
    if presence.alive is False:
        return "lost", "process_gone"
    silent = heard is None or now_ns - heard.arrived_ns > SILENT_AFTER_NS
    if silent and presence.cut_off:
        return "unknown", "unheard"
    if heard is None or heard.health.camera is None:
        says_so = heard is not None and not silent and heard.health.state == "starting"
        young = now_ns - presence.since_ns < START_GRACE_NS
        return ("starting", "starting") if says_so or young else ("lost", "never_seen")
    if silent:
        return "lost", "silent"
    codes = (trouble.code for trouble in heard.health.troubles)
    cause = next((_CAUSES[code] for code in codes if code in _CAUSES), None)
    return _judge_rates(heard.health.camera, cause, heard.health.state == "degraded")


def _judge_rates(camera: CameraHealth, cause: CameraReason | None, degraded: bool) -> tuple[CameraState, CameraReason]:
    if not all(map(math.isfinite, (camera.source_hz, camera.fresh_hz, camera.target_hz, camera.backlog_ms))):
        return "slow", "degraded"  # It works, but how well cannot be known.
    # One that is opened again and again shows a picture each time, and is lost all the same.
    if camera.source_hz <= 0 or (cause is not None and camera.source_hz < SPARSE_HZ):
        return "lost", cause or "no_frames"
    if camera.target_hz <= 0:
        return "ok", "resting"
    faults: tuple[tuple[bool, CameraReason], ...] = (
        (camera.backlog_ms > BACKLOG_MS, "backlog"),
        (camera.fresh_hz < BEHIND_SHARE * camera.target_hz, "behind"),
        (camera.fresh_hz < SPARSE_HZ, "sparse"),
        (degraded, cause or "degraded"),
    )
    reason = next((reason for present, reason in faults if present), None)
    return ("slow", reason) if reason else ("ok", "none")
