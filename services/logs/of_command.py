"""What a command of the command line logs while it works: a sentence a line on stderr, since stdout is for what was asked for."""

import logging
import sys

import structlog
from structlog.typing import EventDict

from services.logs.printable import printable


def configure() -> None:
    """Tell the person at the command line of warnings and what is worse."""
    structlog.configure(
        processors=[_sentence],
        wrapper_class=structlog.make_filtering_bound_logger(logging.WARNING),
        logger_factory=structlog.WriteLoggerFactory(sys.stderr),
    )


def _sentence(_logger: object, _method: str, event: EventDict) -> str:
    details = ", ".join(f"{name}: {value}" for name, value in event.items() if name != "event")
    return printable(f"note: {event['event']}{f' ({details})' if details else ''}")
