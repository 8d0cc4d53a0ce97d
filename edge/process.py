"""The edge process of one camera: grab, look if it is this camera's turn, publish. The newest picture or none."""

import os
import time
from collections.abc import Callable
from dataclasses import dataclass, field

import cv2
import msgspec

from edge.cameras.faulty import FaultySource, Script
from edge.cameras.shape import require_calibrated_size
from edge.cameras.simulated import open_simulated
from edge.cameras.source import Clock, Frame, MonotonicClock, PictureError, Source
from edge.cameras.video import Schedule, VideoSource, load_video
from edge.cameras.watched import WatchedSource
from edge.library import Library
from edge.meter import Meter
from edge.observe import EdgeConfig, EdgeState, Networks, Stages, observe
from edge.perception.detection import load_person_detector
from edge.perception.networks import Provider
from edge.perception.pose import load_pose_network
from edge.turns import CONTROL_LIFETIME_NS, default_control, is_due, missed_turns
from models.config.site import CameraConfig
from models.errors import UserError
from models.messages import codec, topics
from models.messages.control import ViewControl
from models.messages.trouble import Trouble
from models.process import ProcessContext, Subscription

GRAB_TIMEOUT_S = 0.2
"""How long a silent camera keeps the loop from its other duties."""
DETECTION_SCORE_MIN = 0.25
"""People seen from the side score little; a track that turns out to be nobody is dropped after one pose."""
MILLISECOND_NS = 1_000_000


def main(context: ProcessContext) -> None:
    """Serve one camera until `context.stop` is set.

    `context.start_ns` is shared by all processes of a run: epochs are counted from it. A process that is started by hand beside a
    running box needs the box's `--start-ns`; with one of its own its epochs would lag behind, and fusion would ignore them.

    Raises:
        UserError: the camera, its file or the first network cannot be had.
    """
    cv2.setNumThreads(1)
    clock = MonotonicClock()
    config = _camera_config(context)
    source = WatchedSource(lambda: open_source(config, context, clock), config.name, clock)
    try:
        EdgeLoop(context, source, open_library(context), clock).run()
    finally:
        source.close()


def open_library(context: ProcessContext) -> Library:
    """The networks in the data folder, on the execution provider that the site file names."""
    provider = context.site.inference.provider
    return Library(
        load_pose=lambda name: load_pose_network(name, context.data, provider),
        load_detector=lambda: load_person_detector(context.data, provider, DETECTION_SCORE_MIN),
        first="thunder",
    )


def open_source(config: CameraConfig, context: ProcessContext, clock: Clock) -> Source:
    """The source that the site file describes.

    Raises:
        UserError: its file or lesson cannot be played, or its pictures are not of the size that was calibrated.
        SourceError: a fault of the site file's keeps it from being opened now.
    """
    path = context.data / config.path
    if config.kind == "simulated":
        source, shape = open_simulated(path, config.name, context.start_ns, clock)
    else:
        video = load_video(path, config.name)
        shape = video.shape(path)
        delay_ns = round(config.shutter_delay_ms * MILLISECOND_NS)
        source = VideoSource(video, Schedule(context.start_ns, delay_ns, config.rate_hz), clock)
    require_calibrated_size(config.name, shape, context.rig.cameras[context.rig.index(config.name)].size_px)
    faults = [fault for fault in context.site.faults if fault.camera == config.name]
    return FaultySource(source, Script(faults, context.start_ns), clock) if faults else source


def stage_clock(provider: Provider) -> Callable[[], int]:
    """The CPU time that stages are charged, in ns.

    onnxruntime computes in the thread that calls it, so a network that loads beside the loop is not charged to a stage, from
    which fusion's governor would conclude that a pose costs that much. OpenVINO computes in a thread of its own, so with it the
    whole process has to count.
    """
    return time.process_time_ns if provider == "openvino" else time.thread_time_ns


def _camera_config(context: ProcessContext) -> CameraConfig:
    for camera in context.site.cameras:
        if camera.name == context.camera:
            return camera
    raise UserError(f"camera '{context.camera}' is not in the site file; its cameras are {', '.join(context.rig.names)}")


@dataclass
class Plan:
    """Fusion's newest wish, or the default while there is none or it is too old. `refuse` is told why one cannot be read."""

    subscription: Subscription
    fallback: ViewControl
    refuse: Callable[[str], None]
    newest: ViewControl | None = None

    def at(self, now_ns: int) -> ViewControl:
        """The plan to obey now."""
        while (delivery := self.subscription.receive(0.0)) is not None:
            try:
                control = self._read(delivery.payload, now_ns)
            except codec.CodecError as error:
                self.refuse(str(error))
                continue
            # One that is too old waited while this process was held up: it is void, but nothing is wrong with it.
            if now_ns - control.t_ns <= CONTROL_LIFETIME_NS:
                self.newest = control
        if self.newest is not None and now_ns - self.newest.t_ns > CONTROL_LIFETIME_NS:
            self.newest = None
        return self.newest or self.fallback

    def _read(self, payload: bytes, now_ns: int) -> ViewControl:
        control = codec.decode(payload, ViewControl)
        if control.camera != self.fallback.camera:
            raise codec.CodecError(f"it is for camera '{control.camera[:60]}'")
        if control.t_ns - now_ns > CONTROL_LIFETIME_NS:
            raise codec.CodecError(f"it is of {(control.t_ns - now_ns) * 1e-9:.1f} s from now")
        return control


@dataclass
class _Progress:
    """Where the loop is: the step's state and the instants of the last picture grabbed and the last one inferred."""

    state: EdgeState = field(default_factory=EdgeState)
    t_grabbed_ns: int | None = None
    t_inferred_ns: int | None = None


class EdgeLoop:
    """The loop of `main`, with everything from outside passed in.

    Args:
        context: see `ProcessContext`; its camera must be one of the rig's.
        source: where the pictures come from.
        library: the networks.
        clock: CLOCK_MONOTONIC.
    """

    def __init__(self, context: ProcessContext, source: Source, library: Library, clock: Clock) -> None:
        if context.camera is None:
            raise ValueError("an edge process serves a camera")
        self._context = context
        self._camera = context.camera
        self._source = source
        self._library = library
        self._clock = clock
        self._config = EdgeConfig()
        self._stage_clock = stage_clock(context.site.inference.provider)
        position = context.rig.index(self._camera)
        limit_hz = float(context.site.inference.max_rate_hz)
        fallback = default_control(self._camera, position, len(context.rig), context.start_ns, limit_hz)
        now_ns = clock.now_ns()
        self._meter = Meter(context.name, os.getpid(), self._camera, t_report_ns=now_ns, t_picture_ns=now_ns)
        self._plan = Plan(context.bus.subscribe(topics.control(self._camera), keep=1), fallback, self._meter.refused_plan)
        self._progress = _Progress()

    def run(self) -> None:
        """Go on until `context.stop` is set."""
        self._context.bus.declare_alive(topics.alive(self._context.name))
        try:
            while not self._context.stop.is_set():
                control = self._plan.at(self._clock.now_ns())
                skipped_before = self._source.skipped
                frame = self._source.grab(GRAB_TIMEOUT_S)
                if frame is None:
                    self._meter.in_vain(self._clock.now_ns())
                else:
                    self._take(frame, self._source.skipped - skipped_before, control)
                self._report(control)
        finally:
            self._plan.subscription.close()

    def _take(self, frame: Frame, skipped: int, control: ViewControl) -> None:
        """Count a picture, and infer it if it is its turn."""
        progress, meter = self._progress, self._meter
        now_ns = self._clock.now_ns()
        meter.grabbed(now_ns, frame.t_mid_ns, 1 + skipped)
        if progress.t_grabbed_ns is not None:
            meter.skipped += missed_turns(frame.t_mid_ns, progress.t_grabbed_ns, skipped, control)
        progress.t_grabbed_ns = frame.t_mid_ns
        # An epoch's first picture is due for every camera at work: fusion has nothing of it yet.
        seam = control.rate_hz > 0 and progress.state.epoch is not None and frame.epoch != progress.state.epoch
        if seam or is_due(frame.t_mid_ns, progress.t_inferred_ns, control):
            progress.t_inferred_ns = frame.t_mid_ns
            meter.waited(now_ns - frame.t_mid_ns)
            self._infer(frame, control)

    def _infer(self, frame: Frame, control: ViewControl) -> None:
        networks = Networks(self._library.pose(control.network), self._library.detector)
        stages = Stages(self._stage_clock, self._meter.spent_ns)
        try:
            self._progress.state, observation = observe(self._progress.state, frame, networks, control, self._config, stages)
        except PictureError:
            self._meter.damaged += 1
            return
        self._meter.inferred += 1
        self._meter.saw(self._progress.state.bright)
        with stages.measure("encode"):
            stamped = msgspec.structs.replace(observation, t_published_ns=self._clock.now_ns())
            self._context.bus.publish(topics.observation(self._camera), codec.encode(stamped))

    def _report(self, control: ViewControl) -> None:
        now_ns = self._clock.now_ns()
        if not self._meter.is_due(now_ns):
            return
        network = Trouble("network_missing", self._library.problem) if self._library.problem else None
        troubles = tuple(trouble for trouble in (self._source.problem, network) if trouble is not None)
        health = self._meter.report(now_ns, control.rate_hz, self._library.current, troubles, self._context.resources())
        self._context.bus.publish(topics.health(self._context.name), codec.encode(health))
