"""Every number that fusion can be tuned by, in named presets."""

from dataclasses import dataclass, field, replace
from typing import Final, Literal

import numpy as np

from models.arrays import Float
from models.skeleton import coco

_DISTAL: Final = tuple(coco.INDEX[f"{side}_{part}"] for side in ("left", "right") for part in ("wrist", "ankle"))
_MIDDLE: Final = tuple(coco.INDEX[f"{side}_{part}"] for side in ("left", "right") for part in ("elbow", "knee"))


def by_distance_from_trunk(trunk: float, middle: float, distal: float) -> Float:
    """(17,) one value a joint: head, shoulders and hips; elbows and knees; wrists and ankles."""
    values = np.full(coco.COUNT, trunk)
    values[list(_MIDDLE)] = middle
    values[list(_DISTAL)] = distal
    return values


@dataclass(frozen=True, kw_only=True)
class SightingConfig:
    """Which keypoints are believed, and how far.

    Attributes:
        min_score: keypoints below are not used.
        full_score: below this score, sigma grows as full_score / score.
        sigma_floor_px: added in quadrature to every sigma; covers what the network's sigma does not know of.
        doubled: by how much sigma grows of a point that lies on the other limb of its pair (`services.fusion.doubles`); 1 is not
            at all.
    """

    min_score: float = 0.15
    full_score: float = 0.3
    sigma_floor_px: float = 0.5
    doubled: float = 4.0


@dataclass(frozen=True, kw_only=True)
class TimingConfig:
    """Bringing the tracks of several cameras to a common instant.

    Attributes:
        max_gap_s: observations further apart are not interpolated between.
        max_ahead_s: a track is not carried further beyond its newest observation.
        velocity_memory_s: time constant with which a carried velocity dies.
        acceleration_px_s2: (17,) one sigma of image acceleration, by which a gap inflates sigma.
    """

    max_gap_s: float = 0.30
    max_ahead_s: float = 0.15
    velocity_memory_s: float = 0.10
    acceleration_px_s2: Float = field(default_factory=lambda: by_distance_from_trunk(800.0, 1500.0, 3000.0))


@dataclass(frozen=True, kw_only=True)
class TriangulationConfig:
    """Robust triangulation of one joint.

    Attributes:
        robust_sigmas: scale of the Geman-McClure weight on residuals in sigmas.
        inlier_sigmas2: squared residual in sigmas up to which a view is an inlier (chi-square, 2 degrees of freedom, 99 %).
        prior_m: scale of the robust temporal prior.
        max_step_m: bound of one Gauss-Newton step.
        iterations: Gauss-Newton steps.
    """

    robust_sigmas: float = 3.0
    inlier_sigmas2: float = 9.21
    prior_m: float = 0.25
    max_step_m: float = 0.15
    iterations: int = 4


@dataclass(frozen=True, kw_only=True)
class AssociationConfig:
    """Choosing the pupil, and keeping to the choice.

    Attributes:
        person_gate_m: largest median distance, across the line of sight, of a person's keypoints from the expected ones.
        min_agreement: share of a person's keypoints that must be where they are expected if two other cameras see the pupil; a
            network that looks at two people at once mixes them, and what is right of that is not worth what is wrong.
        slack: calibration error, as a share of the body's size in the picture, that the choice of the pupil forgives.
        misses_to_search: consecutive observations without the pupil after which a camera is asked to search.
        patience_s: how long a choice with fewer views than cameras is waited with.
        challenge_s: how long another person must have more views than the chosen one to be chosen instead.
        lookback_s: how far back observations are fused once the pupil is chosen.
        max_age_s: a track older than this is no candidate.
        max_hypotheses: how many persons in space are looked at in one search; the pairs of sightings that agree best propose them.
    """

    person_gate_m: float = 0.20
    min_agreement: float = 0.6
    slack: float = 0.02
    misses_to_search: int = 3
    patience_s: float = 0.25
    challenge_s: float = 1.0
    lookback_s: float = 0.6
    max_age_s: float = 0.4
    max_hypotheses: int = 12


@dataclass(frozen=True, kw_only=True)
class FilterConfig:
    """The filter of each joint: a Singer model, whose acceleration and velocity die away if nothing confirms them.

    Attributes:
        acceleration_m_s2: (17,) one sigma of acceleration.
        acceleration_memory_s: time constant of acceleration.
        velocity_memory_s: time constant with which velocity dies.
        max_speed_m_s: bound of velocity.
        soft_gate: squared innovation in sigmas from which a measurement loses weight.
        hard_gate: squared innovation in sigmas from which it is refused (chi-square, 2 degrees of freedom, 99.97 %).
        reseed_gate: squared distance in sigmas at which triangulation and filter disagree (3 degrees of freedom, 99.9 %).
        reseed_after: consecutive ticks of disagreement after which the filter starts anew.
        view_memory_s: a view supports a joint for so long.
        guess_s: a joint is carried for so long with fewer than two views.
        max_sigma_m: a joint less certain than this is unknown.
        history: observations that can be gone back over when one arrives late.
    """

    acceleration_m_s2: Float = field(default_factory=lambda: by_distance_from_trunk(4.0, 10.0, 40.0))
    acceleration_memory_s: float = 0.06
    velocity_memory_s: float = 0.5
    max_speed_m_s: float = 20.0
    soft_gate: float = 6.0
    hard_gate: float = 16.0
    reseed_gate: float = 16.3
    reseed_after: int = 2
    view_memory_s: float = 0.25
    guess_s: float = 8 / 30
    max_sigma_m: float = 0.25
    history: int = 24


@dataclass(frozen=True, kw_only=True)
class SmoothingConfig:
    """The smoother: a window of positions on the output grid, eq. 8 with a data term.

    Attributes:
        order: order of the difference that is penalised: 3 measured best, the paper's is 2.
        difference_m: (17,) one sigma of that difference at 30 Hz; the square root of the inverse of eq. 8's gamma.
        difference_freedom: freedom of Student's t that the differences are taken to follow; infinite is a Gaussian.
        bend_m: (17,) one sigma of the second difference: no joint accelerates without bound.
        carry_s: time constant with which velocity dies beyond the newest picture.
        knots: length of the window in grid instants.
        iterations: reweighting steps a tick; a position is stepped on in every tick that it is in the window.
        robust_sigmas: as in triangulation.
        recapture_views: by how many views fewer must object to a triangulated position than to the smoother's for it to go on from
            there; infinite is never.
        between_looks: share of the way that a joint makes from one look at it to the next, of all cameras together, by which it is
            unsure along that way.
        limb_sigma: one sigma of a limb's length as a share of it (eq. 16); infinite switches the term off.
        limb_samples: instants over which a limb's length is estimated.
    """

    order: Literal[2, 3] = 3
    difference_m: Float = field(default_factory=lambda: by_distance_from_trunk(0.003, 0.005, 0.025))
    difference_freedom: float = 2.0
    carry_s: float = 0.10
    bend_m: Float = field(default_factory=lambda: by_distance_from_trunk(0.03, 0.06, 0.15))
    knots: int = 18
    iterations: int = 1
    robust_sigmas: float = 3.0
    recapture_views: float = 0.5
    between_looks: float = 0.5
    limb_sigma: float = 0.03
    limb_samples: int = 90


@dataclass(frozen=True, kw_only=True)
class FusionConfig:
    """All stages.

    Attributes:
        frame_s: the output grid, and what a lag of "frames" means.
        live_lag_frames: how far live output is behind the tick.
        smooth_lag_frames: how far smooth output is behind live output.
        landmark_bias: (17, 3) what is taken off the joints that are given out, see `services.fusion.landmarks`; None takes nothing.
    """

    preset: str
    frame_s: float = 1 / 30
    live_lag_frames: int = 2
    smooth_lag_frames: int = 5
    landmark_bias: Float | None = None
    sighting: SightingConfig = SightingConfig()
    timing: TimingConfig = TimingConfig()
    triangulation: TriangulationConfig = TriangulationConfig()
    association: AssociationConfig = AssociationConfig()
    filter: FilterConfig = FilterConfig()
    smoothing: SmoothingConfig = SmoothingConfig()


def _paper() -> FusionConfig:
    """Eq. 8 as printed: second difference, distal joints smoothed most; no limb-length residual on joints that are seen, nothing
    caught again, no doubt of limbs that are named twice, and no word of what happened between the pictures."""
    gamma = by_distance_from_trunk(0.020, 0.011, 0.006)
    never = float("inf")
    smoothing = SmoothingConfig(order=2, difference_m=gamma, limb_sigma=never, recapture_views=never, between_looks=0.0)
    return replace(FusionConfig(preset="paper"), sighting=SightingConfig(doubled=1.0), smoothing=smoothing)


PRESETS: Final = {"default": FusionConfig(preset="default"), "paper": _paper()}
