"""Amounts of memory and disk for people: in decimal units, as the site file counts and as disks are sold. Pure.

Messages count in MiB, as their fields' names say. A figure in those under the name of MB would contradict every other one by a
twentieth.
"""

import math


def megabytes(mib: float) -> float:
    """MiB in MB."""
    return mib * 2**20 / 1e6


def size_of(mib: float) -> str:
    """An amount of memory or disk for people."""
    if math.isnan(mib):
        return "an unknown amount"
    mb = megabytes(mib)
    return f"{mb:.0f} MB" if mb < 999.5 else f"{mb / 1000:.1f} GB"
