"""Laws of the motion frame: reading undoes writing, and reducing a motion loses at most half a millimetre."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from models.arrays import Float32
from models.messages.motion import JointState, Motion
from models.skeleton import coco
from services.tablet import motion_frame
from services.tablet.motion_frame import MotionFrame
from tests.golden.motion_frame.vectors import differences

INT64 = st.integers(-(2**63), 2**63 - 1)
UINT32 = st.integers(0, 2**32 - 1)

frames = st.builds(
    MotionFrame,
    kind=st.sampled_from(motion_frame.KINDS),
    sequence=UINT32,
    epoch=UINT32,
    t_ns=INT64,
    t_newest_ns=INT64,
    server_latency_us=UINT32,
    out_of_range=st.booleans(),
    positions_mm=arrays.arrays(np.int16, (coco.COUNT, 3)),
    sigma_mm=arrays.arrays(np.uint16, coco.COUNT),
    states=arrays.arrays(np.uint8, coco.COUNT, elements=st.integers(0, 2)),
    views=arrays.arrays(np.uint8, coco.COUNT),
)


@given(frames)
def test_reading_undoes_writing(frame: MotionFrame) -> None:
    data = motion_frame.pack(frame)
    assert len(data) == motion_frame.SIZE
    assert differences(motion_frame.unpack(data), frame) == []


@given(arrays.arrays(np.float32, (coco.COUNT, 3), elements=st.floats(-100, 100, width=32)))
def test_a_position_is_right_to_half_a_millimetre_or_withheld(joints_m: Float32) -> None:
    motion = Motion(
        kind="live",
        sequence=0,
        epoch=0,
        t_ns=0,
        t_newest_ns=0,
        t_published_ns=0,
        joints_m=joints_m,
        covariance_m2=np.zeros((coco.COUNT, 3, 3), np.float32),
        states=np.full(coco.COUNT, JointState.SEEN, np.uint8),
        views=np.zeros(coco.COUNT, np.uint32),
        cameras=(),
    )
    frame = motion_frame.from_motion(motion, now_ns=0)
    seen = frame.states == JointState.SEEN
    assert np.abs(frame.positions_mm[seen] - 1000 * joints_m[seen].astype(np.float64)).max(initial=0) <= 0.5
    assert np.abs(joints_m[~seen]).max(axis=-1, initial=0).min(initial=np.inf) > 32.767 - 0.0005
    assert frame.out_of_range == (not seen.all())
