"""A report as JSON, for programs. docs/report.md describes every field."""

import msgspec

from services.evaluation.report.document import Report


def encode(report: Report) -> bytes:
    """The file: UTF-8, indented, ends with a line's end."""
    return msgspec.json.format(msgspec.json.encode(report), indent=2) + b"\n"
