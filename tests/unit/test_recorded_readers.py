"""Recordings of markers and forces: what their files say, and that every fault in one is named by its line."""

import numpy as np
import pytest

from models.errors import UserError
from models.motions.recorded import force, marker_csv, trc

TRC = (
    "PathFileType\t4\t(X/Y/Z)\tjump.trc\n"
    "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames\n"
    "100\t100\t3\t2\tmm\t100\t0\t3\n"
    "Frame#\tTime\tC7\t\t\tL.ASIS\t\t\n"
    "\t\tX1\tY1\tZ1\tX2\tY2\tZ2\n"
    "\n"
    "1\t0.00\t1000\t2000\t3000\t4\t5\t6\n"
    "2\t0.01\t1001\t2000\t3000\t\t\t\n"
    "3\t0.02\t1002\t2000\t3000\t4\t5\t6\n"
)
CSV = "Time,C7[0],C7[1],C7[2],RWRA[0],RWRA[1],RWRA[2]\n0,1,2,3,4,5,6\n0.02,1,2,3,,,\n0.04,1,2,3,4,5,6\n"
FORCE = "time_s,force_N\n" + "".join(f"{0.01 * row:.2f},{0 if row < 10 or 30 <= row < 70 else 700}\n" for row in range(100))


def test_a_trc_file_has_its_up_turned_to_z_and_its_units_to_metres() -> None:
    markers = trc.decode(TRC.encode(), "jump.trc")
    assert markers.names == ("C7", "L.ASIS")
    assert markers.rate_hz == 100
    assert markers.of("C7")[0] == pytest.approx((1.0, -3.0, 2.0))
    assert np.isnan(markers.of("L.ASIS")[1]).all()
    assert markers.times_s == pytest.approx((0, 0.01, 0.02))


def test_a_trc_file_without_the_empty_line_or_with_windows_line_ends_reads_alike() -> None:
    plain = trc.decode(TRC.encode(), "jump.trc").positions_m
    for text in (TRC.replace("\n\n", "\n"), TRC.replace("\n", "\r\n")):
        np.testing.assert_array_equal(trc.decode(text.encode(), "jump.trc").positions_m, plain)


@pytest.mark.parametrize(
    ("old", "new", "named"),
    [
        ("PathFileType", "Path", "jump.trc: is no TRC file"),
        ("\t2\tmm", "\t3\tmm", "NumMarkers is 3, but line 4 names 2"),
        ("\tmm\t", "\tinch\t", "Units is 'inch', known are m and mm"),
        ("\tNumFrames\t", "\tFrames\t", "line 2: NumFrames is missing"),
        ("100\t100\t3\t", "100\t100\tmany\t", "line 3: NumFrames is 'many'"),
        ("3\t0.02\t1002\t2000\t3000\t4\t5\t6\n", "", "NumFrames is 3, but 2 frames follow; is it cut off"),
        ("Frame#\tTime", "Frame\tTime", "line 4: must begin with Frame# and Time"),
        ("C7\t\t\t", "C7\t\tT10\t", "line 4: each marker's name must be followed by two empty cells"),
        ("L.ASIS", "C7", "two markers are named 'C7'"),
        ("1001", "x1001", "line 8, value 3: 'x1001' is no number"),
        ("1001", "inf", "line 8, value 3: 'inf' is not finite"),
        ("\t4\t5\t6\n2", "\t4\t5\n2", "line 7: has 7 values, needed 8"),
        ("\t4\t5\t6\n2", "\t4\t5\t6\t7\n2", "line 7: has 9 values, needed 8"),
        ("0.02\t", "0.03\t", "equal steps; row 2 of numbers does not"),
        ("100\t100\t3", "50\t50\t3", "DataRate is 50 frames a second, but the times tell 100"),
    ],
)
def test_a_fault_of_a_trc_file_is_named(old: str, new: str, named: str) -> None:
    assert old in TRC
    with pytest.raises(UserError, match=named):
        trc.decode(TRC.replace(old, new, 1).encode(), "jump.trc")


@pytest.mark.parametrize("data", [b"", b"\n\n", b"\xff\xfe\x00", TRC.encode()[:200]])
def test_what_is_no_trc_file_is_refused(data: bytes) -> None:
    with pytest.raises(UserError, match=r"^jump\.trc"):
        trc.decode(data, "jump.trc")


def test_a_csv_of_markers_reads_as_it_is() -> None:
    markers = marker_csv.decode(CSV.encode(), "serve.csv")
    assert markers.names == ("C7", "RWRA")
    assert markers.rate_hz == pytest.approx(50)
    assert markers.of("RWRA")[2] == pytest.approx((4, 5, 6))
    assert np.isnan(markers.of("RWRA")[1]).all()


@pytest.mark.parametrize(
    ("old", "new", "named"),
    [
        ("Time,", "Frame,", "serve.csv, line 1: needed are Time"),
        ("C7[2]", "C7[3]", "line 1: columns 2 to 4 are not"),
        ("C7[1]", "T10[1]", "line 1: columns 2 to 4 are not"),
        ("RWRA", "C7", "two markers are named 'C7'"),
        ("0.02,1,2,3", "0.02,1,2,c", "line 3, value 4: 'c' is no number"),
        ("0,1,2,3,4,5,6\n", "0,1,2,3,4,5\n", "line 2: has 6 values, needed 7"),
        ("0.04", "0.05", "equal steps; row 2 of numbers"),
    ],
)
def test_a_fault_of_a_csv_of_markers_is_named(old: str, new: str, named: str) -> None:
    with pytest.raises(UserError, match=named.replace("[", r"\[")):
        marker_csv.decode(CSV.replace(old, new).encode(), "serve.csv")


def test_the_flight_between_two_landings_is_found() -> None:
    recording = force.decode(FORCE.encode(), "plate.csv")
    assert recording.flights_s() == [pytest.approx((0.30, 0.70))]
    assert force.jump_height_m(0.4) == pytest.approx(9.81 * 0.2**2 / 2)


def test_who_begins_on_the_plate_flies_when_he_leaves_it() -> None:
    standing = force.VerticalForce(100.0, np.repeat((700.0, 0.0, 700.0), 10))
    assert standing.flights_s() == [pytest.approx((0.1, 0.2))]


@pytest.mark.parametrize(
    ("old", "new", "named"),
    [
        ("force_N", "force_kN", "line 1: the columns must be time_s,force_N"),
        ("0.01,0", "0.01,", "line 3: a value is missing"),
        ("0.01,0", "0.01,0,0", "line 3: has 3 values"),
    ],
)
def test_a_fault_of_a_force_file_is_named(old: str, new: str, named: str) -> None:
    with pytest.raises(UserError, match=named):
        force.decode(FORCE.replace(old, new, 1).encode(), "plate.csv")
