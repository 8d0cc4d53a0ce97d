"""Numbers as lines of text, one at a time: a lesson has millions of them."""

from collections.abc import Iterator

from models.arrays import Float


def rows(values: Float, digits: int, separator: str) -> Iterator[str]:
    """A line of each row of (T, n) with so many digits behind the point; nothing where a number is NaN."""
    form = separator.join([f"%.{digits}f"] * values.shape[1])
    for row in values:
        yield (form % tuple(row.tolist())).replace("nan", "")
