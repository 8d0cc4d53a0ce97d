"""Logs: one line of JSON a message on stderr, or readable lines when a person watches a terminal.

The lines of our own code and those of the libraries, which use the standard library's logging, come out alike. Each carries
the name of its process.
"""

import logging
import sys
from typing import TextIO

import structlog
from structlog.typing import Processor


def configure(process: str, stream: TextIO | None = None) -> None:
    """Send everything that this process logs to `stream` (stderr unless given), with the process's name bound to it."""
    output = stream or sys.stderr
    shared: list[Processor] = [
        structlog.contextvars.merge_contextvars,
        structlog.stdlib.add_log_level,
        structlog.processors.TimeStamper(fmt="iso", utc=True, key="time"),
        _named(process),
    ]
    rendered: list[Processor]
    if output.isatty():
        rendered = [structlog.dev.ConsoleRenderer(timestamp_key="time")]
    else:
        rendered = [structlog.processors.format_exc_info, structlog.processors.JSONRenderer()]

    structlog.configure(
        processors=[*shared, structlog.processors.StackInfoRenderer(), *rendered],
        wrapper_class=structlog.make_filtering_bound_logger(logging.INFO),
        logger_factory=structlog.WriteLoggerFactory(output),
        cache_logger_on_first_use=True,
    )
    handler = logging.StreamHandler(output)
    handler.setFormatter(
        structlog.stdlib.ProcessorFormatter(
            foreign_pre_chain=shared, processors=[structlog.stdlib.ProcessorFormatter.remove_processors_meta, *rendered]
        )
    )
    logging.basicConfig(handlers=[handler], level=logging.WARNING, force=True)


def _named(process: str) -> Processor:
    def bind(_logger: object, _method: str, event: structlog.typing.EventDict) -> structlog.typing.EventDict:
        event["process"] = process
        return event

    return bind
