"""Counts what an edge process does and turns it into a health message once a second."""

from dataclasses import dataclass, field

from models.messages.health import CameraHealth, Health
from models.messages.trouble import SOURCE_CODES, Trouble
from models.process import Resources

PERIOD_NS = 1_000_000_000
BLACK_LEVEL = 24.0
"""A covered lens delivers grey levels below this, a dim gym some places above 60."""
SILENT_NS = 700_000_000
"""A camera that showed nothing for this long, and for two of its pictures, is reported, and at once."""


@dataclass
class Meter:
    """What happened since the last report, and the totals since the start."""

    process: str
    pid: int
    camera: str
    t_report_ns: int
    t_picture_ns: int
    t_in_vain_ns: int = 0
    t_mid_ns: int | None = None
    t_mid_reported_ns: int | None = None
    skipped: int = 0
    pictures: int = 0
    inferred: int = 0
    damaged: int = 0
    refused: int = 0
    refusal: str = ""
    backlog_ns: int = 0
    bright: float | None = None
    spacing_ns: int = 0
    silence_told: bool = False
    spent_ns: dict[str, int] = field(default_factory=dict)

    def grabbed(self, t_now_ns: int, t_mid_ns: int, pictures: int) -> None:
        """A grab moved the source on by that many pictures, the newest of that instant."""
        self.pictures += pictures
        self.t_picture_ns = t_now_ns
        if self.t_mid_ns is not None:
            self.spacing_ns = t_mid_ns - self.t_mid_ns
        self.t_mid_ns = t_mid_ns

    def in_vain(self, t_now_ns: int) -> None:
        """A grab ran out of time: only then is it the camera that shows nothing, and not this process that did not look."""
        self.t_in_vain_ns = t_now_ns

    def waited(self, age_ns: int) -> None:
        """A picture had this age when its turn came."""
        self.backlog_ns = max(self.backlog_ns, age_ns)

    def saw(self, bright: float | None) -> None:
        """The brightest places of a picture had this grey level."""
        if bright is not None:
            self.bright = bright if self.bright is None else max(self.bright, bright)

    def refused_plan(self, why: str) -> None:
        """A plan of fusion's cannot be obeyed."""
        self.refused += 1
        self.refusal = why

    def is_due(self, t_now_ns: int) -> bool:
        """Whether a second has passed since the last report, or the camera has just fallen silent."""
        return t_now_ns - self.t_report_ns >= PERIOD_NS or (self._silent() and not self.silence_told)

    def report(self, t_now_ns: int, target_hz: float, network: str, troubles: tuple[Trouble, ...], used: Resources) -> Health:
        """The health message of the time since the last report; counting begins anew. `troubles` are those of other parts."""
        seconds = max(1e-9, (t_now_ns - self.t_report_ns) * 1e-9)
        everything = (*self._troubles(excused=any(each.code in SOURCE_CODES for each in troubles)), *troubles)
        self.silence_told = self._silent()
        camera = CameraHealth(
            camera=self.camera,
            source_hz=self._source_hz(seconds),
            fresh_hz=self.inferred / seconds,
            target_hz=target_hz,
            skipped=self.skipped,
            backlog_ms=self.backlog_ns * 1e-6,
            network=network,
            stage_ms={stage: spent * 1e-6 / max(1, self.inferred) for stage, spent in self.spent_ns.items()},
        )
        self.pictures = self.inferred = self.damaged = self.refused = self.backlog_ns = 0
        self.bright = None
        self.spent_ns = dict.fromkeys(self.spent_ns, 0)
        self.t_report_ns = t_now_ns
        self.t_mid_reported_ns = self.t_mid_ns
        return Health(
            process=self.process,
            pid=self.pid,
            t_ns=t_now_ns,
            state="degraded" if everything else "ok",
            troubles=everything,
            cpu_cores=used.cpu_cores,
            rss_mib=used.rss_mib,
            camera=camera,
        )

    def _source_hz(self, seconds: float) -> float:
        """By the pictures' own times: after a second without a grab, the pictures of two seconds are counted at once."""
        if self._silent():
            return 0.0
        if self.t_mid_ns is None or self.t_mid_reported_ns is None or self.t_mid_ns <= self.t_mid_reported_ns:
            return self.pictures / seconds
        return self.pictures / ((self.t_mid_ns - self.t_mid_reported_ns) * 1e-9)

    def _silence_ns(self) -> int:
        return self.t_in_vain_ns - self.t_picture_ns

    def _silent(self) -> bool:
        return self._silence_ns() >= max(SILENT_NS, 2 * self.spacing_ns)

    def _troubles(self, *, excused: bool) -> tuple[Trouble, ...]:
        """What these counts show; that it seems silent is no news of a camera that is `excused`, since the reason is known."""
        camera = f"camera '{self.camera}'"
        found = []
        if self._silent() and not excused:
            words = f"{camera} has shown nothing for {self._silence_ns() * 1e-9:.0f} s"
            found.append(Trouble("camera_silent", words, "check its cable, its power and its file; unplug it and plug it in again"))
        if self.bright is not None and self.bright < BLACK_LEVEL:
            found.append(
                Trouble("camera_dark", f"{camera} shows black pictures", "take the cap off its lens, or turn on the light")
            )
        if self.damaged:
            words = f"{camera}: {self.damaged} damaged pictures in the last second"
            found.append(Trouble("pictures_damaged", words, "check its cable and its file"))
        if self.refused:
            words = f"{camera}: {self.refused} plans of fusion's could not be read in the last second ({self.refusal})"
            found.append(Trouble("plans_refused", words, "look for a process of another version; end the box and start it anew"))
        return tuple(found)
