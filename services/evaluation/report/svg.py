"""Elements of a drawing as text. Lengths are millimetres on the paper."""

from collections.abc import Iterable

from services.evaluation.report.numbers import escaped

Point = tuple[float, float]


def element(name: str, content: str = "", **attributes: str | float) -> str:
    """`_` in the name of an attribute is a hyphen, one at its end is left out: `class_`, `stroke_width`."""
    written = "".join(f' {key.rstrip("_").replace("_", "-")}="{_value(value)}"' for key, value in attributes.items())
    return f"<{name}{written}>{content}</{name}>" if content else f"<{name}{written}/>"


def drawing(width: float, height: float, content: str, label: str) -> str:
    """A whole drawing of so many millimetres, with what it shows in words for those who cannot see it."""
    size = {"width": f"{length(width)}mm", "height": f"{length(height)}mm", "viewBox": f"0 0 {length(width)} {length(height)}"}
    return element("svg", content, role="img", aria_label=label, **size)


def line(start: Point, end: Point, class_: str) -> str:
    """A straight line."""
    return element("line", x1=start[0], y1=start[1], x2=end[0], y2=end[1], class_=class_)


def path(points: Iterable[Point], class_: str, *, closed: bool = False) -> str:
    """Straight lines through points."""
    corners = " ".join(f"{length(x)},{length(y)}" for x, y in points)
    return element("polygon" if closed else "polyline", points=corners, class_=class_)


def strokes(ends: Iterable[tuple[Iterable[float], Iterable[float]]], class_: str) -> str:
    """Straight lines from one place to another each, as one path; empty if there are none."""
    drawn = "".join(f"M{_place(begin)}L{_place(end)}" for begin, end in ends)
    return element("path", d=drawn, class_=class_) if drawn else ""


def text(place: Point, content: str, class_: str, anchor: str = "start") -> str:
    """A line of text, escaped."""
    return element("text", escaped(content), x=place[0], y=place[1], class_=class_, text_anchor=anchor)


def length(value: float) -> str:
    """To a hundredth of a millimetre; the same everywhere."""
    return f"{round(value, 2) + 0.0:.2f}".rstrip("0").rstrip(".")


def _place(place: Iterable[float]) -> str:
    return ",".join(length(value) for value in place)


def _value(value: str | float) -> str:
    return escaped(value) if isinstance(value, str) else length(value)
