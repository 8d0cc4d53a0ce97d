"""Who is looked at in the next picture: detected people become tracks, tracks become crops, poses move tracks.

Pure: a state goes in and comes out. A full-frame detection costs as much as one to two poses, so a track is followed by its own
keypoints, or by fusion's prediction, and the detector runs only to find someone.
"""

from dataclasses import dataclass, replace

import numpy as np

from edge.perception.crop import blended, crop_from_box, crop_from_pose
from models.arrays import Bool, Float
from models.messages.control import ViewControl
from models.messages.observation import Crop, Person

SECOND_NS = 1_000_000_000


@dataclass(frozen=True)
class TrackingConfig:
    """When a track is believed and how often is searched.

    Attributes:
        joint_score: a keypoint of at least this score is confident.
        joints_min: fewer confident keypoints than this are nobody.
        prediction_ns: fusion's prediction is used up to this age.
        detect_ns: shortest time between two detections while someone is tracked.
        retry_ns: the same while nobody is.
        people_max: tracks kept in a search.
        looks_max: poses a picture in a search; more tracks than that take turns.
        jump: movement of a pose between two looks, over the crop's side, that is taken for another person.
        same: mean distance of two poses, over the crop's side, under which they are one person.
        settle: share of the way that a crop moves towards the newest pose.
    """

    joint_score: float = 0.3
    joints_min: int = 5
    prediction_ns: int = 300_000_000
    detect_ns: int = SECOND_NS
    retry_ns: int = SECOND_NS // 4
    people_max: int = 3
    looks_max: int = 2
    jump: float = 0.35
    same: float = 0.08
    settle: float = 0.5


@dataclass(frozen=True)
class Track:
    """One person in this camera: where to look next, and since when the place is known."""

    number: int
    crop: Crop
    t_ns: int
    velocity_px_s: tuple[float, float] = (0.0, 0.0)
    seen: bool = False

    def at(self, t_ns: int) -> Crop:
        """The crop carried to `t_ns` at constant velocity, by at most a quarter of its side."""
        seconds = (t_ns - self.t_ns) * 1e-9
        step = np.array(self.velocity_px_s) * seconds
        step *= min(1.0, 0.25 * self.crop.side_px / max(1e-9, float(np.hypot(*step))))
        return replace_centre(self.crop, self.crop.centre_x_px + float(step[0]), self.crop.centre_y_px + float(step[1]))


@dataclass(frozen=True)
class Look:
    """One crop to run the pose network on, for the track of that number."""

    number: int
    crop: Crop


@dataclass(frozen=True)
class Tracks:
    """State of one camera's tracking.

    Attributes:
        people: the tracks, oldest first.
        next_number: of the next track; never used twice.
        focus: number of the pupil's track, once fusion has pointed at it.
        turn: counts the looks of a search, for taking turns.
        t_detected_ns: when the detector last ran; None at the beginning.
    """

    people: tuple[Track, ...] = ()
    next_number: int = 0
    focus: int | None = None
    turn: int = 0
    t_detected_ns: int | None = None

    def across_seam(self, t_ns: int) -> "Tracks":
        """What is left in a new epoch: where the pupil was is the first place to look; everyone else is forgotten.

        The place is a guess about where to look and no estimate: a pose there must be as confident as a newcomer's.
        """
        pupil = tuple(Track(track.number, track.crop, t_ns) for track in self.people if track.number == self.focus)
        return Tracks(pupil, next_number=self.next_number, focus=self.focus if pupil else None)


def replace_centre(crop: Crop, x_px: float, y_px: float) -> Crop:
    """The same square elsewhere."""
    return Crop(x_px, y_px, crop.side_px, crop.angle_rad)


def fresh_prediction(control: ViewControl, t_ns: int, config: TrackingConfig) -> Crop | None:
    """Fusion's crop carried to `t_ns`, unless it searches, has none or it is too old."""
    prediction = control.prediction
    if control.search or prediction is None or abs(t_ns - prediction.t_ns) > config.prediction_ns:
        return None
    return prediction.at(t_ns)


def wants_detection(tracks: Tracks, control: ViewControl, t_ns: int, config: TrackingConfig) -> bool:
    """Whether the detector shall run on the picture of `t_ns`."""
    if fresh_prediction(control, t_ns, config) is not None:
        return False
    following = not control.search and any(track.number == tracks.focus for track in tracks.people)
    if following:
        return False
    wait_ns = config.detect_ns if tracks.people else config.retry_ns
    return tracks.t_detected_ns is None or t_ns - tracks.t_detected_ns >= wait_ns


def with_detections(tracks: Tracks, boxes_px: Float, t_ns: int, config: TrackingConfig) -> Tracks:
    """Detected boxes (n, 4), best first, that no track accounts for become new tracks."""
    people, number = list(tracks.people), tracks.next_number
    for box in boxes_px:
        crop = crop_from_box(box)
        if len(people) < config.people_max and not any(_overlaps(crop, track.at(t_ns)) for track in people):
            people.append(Track(number, crop, t_ns))
            number += 1
    return replace(tracks, people=tuple(people), next_number=number, t_detected_ns=t_ns)


def choose_looks(tracks: Tracks, control: ViewControl, t_ns: int, config: TrackingConfig) -> tuple[Tracks, tuple[Look, ...]]:
    """The crops to look at in the picture of `t_ns`: the pupil's alone if it is known, else everyone's in turn."""
    predicted = fresh_prediction(control, t_ns, config)
    if predicted is not None:
        tracks = _focused(tracks, predicted, t_ns)
        return tracks, tuple(Look(track.number, predicted) for track in tracks.people)
    if not control.search:
        pupil = tuple(track for track in tracks.people if track.number == tracks.focus)
        if pupil:
            return replace(tracks, people=pupil), (Look(pupil[0].number, pupil[0].at(t_ns)),)
    count = len(tracks.people)
    order = [tracks.people[(tracks.turn + i) % count] for i in range(min(count, config.looks_max))]
    return replace(tracks, turn=tracks.turn + len(order)), tuple(Look(track.number, track.at(t_ns)) for track in order)


def with_poses(tracks: Tracks, poses: tuple[Person, ...], t_ns: int, config: TrackingConfig) -> tuple[Tracks, tuple[Person, ...]]:
    """Move the tracks that were looked at; drop those where nobody was, and the younger of two on one person.

    Returns:
        The new state, and the poses that are believed, the most confident first.
    """
    looked = {pose.track: pose for pose in poses}
    people: list[Track] = []
    kept: list[Person] = []
    for track in tracks.people:
        pose = looked.get(track.number)
        if pose is None:
            people.append(track)
            continue
        confident = confident_joints(pose, config)
        if confident.sum() < config.joints_min or any(_is_same(pose, other, config) for other in kept):
            continue
        moved = _moved(track, pose, confident, t_ns, config)
        if moved is not None:
            people.append(moved)
            kept.append(pose)
    kept.sort(key=lambda pose: -float(pose.score.mean()))
    return replace(tracks, people=tuple(people)), tuple(kept)


def confident_joints(pose: Person, config: TrackingConfig) -> Bool:
    """(17,) keypoints whose score is high enough and that lie within the crop."""
    inside = (np.abs(pose.crop.to_crop(pose.keypoints_px.astype(np.float64)) - 0.5) <= 0.5).all(axis=1)
    confident: Bool = (pose.score >= config.joint_score) & inside
    return confident


def _focused(tracks: Tracks, predicted: Crop, t_ns: int) -> Tracks:
    """Only the pupil's track: the one that the prediction points at, or a new one."""
    distances = [(_distance(track.at(t_ns), predicted) / predicted.side_px, track) for track in tracks.people]
    distance, nearest = min(distances, key=lambda pair: pair[0], default=(np.inf, None))
    if nearest is not None and distance < 0.25:
        return replace(tracks, people=(nearest,), focus=nearest.number)
    track = Track(tracks.next_number, predicted, t_ns)
    return replace(tracks, people=(track,), focus=track.number, next_number=track.number + 1)


def _moved(track: Track, pose: Person, confident: Bool, t_ns: int, config: TrackingConfig) -> Track | None:
    """The track after a look; None if the pose is so far from where it was expected that it is another person's."""
    expected = pose.crop
    crop = crop_from_pose(pose.keypoints_px.astype(np.float64), confident, expected)
    if not track.seen:
        return replace(track, crop=crop, t_ns=t_ns, seen=True)
    if _distance(crop, expected) > config.jump * expected.side_px:
        return None
    calm = blended(expected, crop, config.settle)
    seconds = (t_ns - track.t_ns) * 1e-9
    if seconds <= 0:
        return replace(track, crop=calm, t_ns=t_ns)
    # Half old, half new: the centre of a crop moves with the arms, too.
    x = 0.5 * track.velocity_px_s[0] + 0.5 * (calm.centre_x_px - track.crop.centre_x_px) / seconds
    y = 0.5 * track.velocity_px_s[1] + 0.5 * (calm.centre_y_px - track.crop.centre_y_px) / seconds
    return replace(track, crop=calm, t_ns=t_ns, velocity_px_s=(x, y))


def _distance(a: Crop, b: Crop) -> float:
    return float(np.hypot(a.centre_x_px - b.centre_x_px, a.centre_y_px - b.centre_y_px))


def _overlaps(a: Crop, b: Crop) -> bool:
    """Whether two crops are of one person: centres near, sizes alike."""
    larger, smaller = max(a.side_px, b.side_px), min(a.side_px, b.side_px)
    return _distance(a, b) < 0.3 * larger and smaller > 0.5 * larger


def _is_same(a: Person, b: Person, config: TrackingConfig) -> bool:
    both = (a.score >= config.joint_score) & (b.score >= config.joint_score)
    if both.sum() < config.joints_min:
        return False
    distance = np.linalg.norm(a.keypoints_px[both] - b.keypoints_px[both], axis=1).mean()
    return bool(distance < config.same * min(a.crop.side_px, b.crop.side_px))
