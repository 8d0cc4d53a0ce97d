"""TRC, the text format of marker positions that OpenSim reads: millimetres, y up, nothing where a point is unknown."""

from services.lesson.export.axes import OPENSIM
from services.lesson.export.labels import LABELS
from services.lesson.export.rows import rows
from services.lesson.export.take import Take

SUFFIX = ".trc"
_MM = 1000.0


def encode(take: Take) -> bytes:
    """The file. Positions are rounded to a hundredth of a millimetre; what TRC has no place for stands in `Take.about`."""
    count, rate = len(take.track), f"{take.rate_hz:.6g}"
    columns = [f"{axis}{number}" for number in range(1, len(LABELS) + 1) for axis in "XYZ"]
    head = [
        f"PathFileType\t4\t(X/Y/Z)\t{' '.join(take.name.split())}{SUFFIX}",
        "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames",
        f"{rate}\t{rate}\t{count}\t{len(LABELS)}\tmm\t{rate}\t1\t{count}",
        "\t".join(("Frame#", "Time", *(f"{label}\t\t" for label in LABELS))),
        "\t".join(("", "", *columns)),
        "",
    ]
    values = OPENSIM.to(take.joints_m).reshape(count, -1) * _MM
    lines = (
        f"{frame}\t{seconds:.6f}\t{line}"
        for frame, (seconds, line) in enumerate(zip(take.seconds, rows(values, 2, "\t"), strict=True), start=1)
    )
    return ("\n".join((*head, *lines)) + "\n").encode()
