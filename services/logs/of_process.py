"""Logs of a process: one line a message on stderr, or readable lines when a person watches a terminal.

The lines of our own code and those of the libraries, which use the standard library's logging, come out alike, in the form of
`services.logs.record`; so does what ends the process or one of its threads.
"""

import datetime as dt
import faulthandler
import io
import logging
import sys
import threading
from contextlib import suppress
from types import TracebackType
from typing import TextIO

import structlog
from structlog.typing import EventDict, Processor

from services.logs.record import encode, record_of


def configure(process: str, stream: TextIO | None = None) -> None:
    """Send everything that this process logs to `stream` (stderr unless given), with the process's name bound to it."""
    output = stream or sys.stderr
    shared: list[Processor] = [structlog.contextvars.merge_contextvars, structlog.stdlib.add_log_level, _named(process)]
    rendered: list[Processor]
    if output.isatty():
        clock = structlog.processors.TimeStamper(fmt="%H:%M:%S", utc=False, key="time")
        # Tracebacks without the values of variables, which may be pictures.
        rendered = [clock, structlog.dev.ConsoleRenderer(timestamp_key="time", exception_formatter=structlog.dev.plain_traceback)]
    else:
        rendered = [structlog.processors.format_exc_info, _line_of_record]

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


def log_what_ends_us() -> None:
    """Log, as one record, the exception that ends this process or a thread of it; where native code ended it is printed."""
    sys.excepthook = _log_end
    threading.excepthook = _log_end_of_thread
    with suppress(io.UnsupportedOperation):  # A stream that is no file has no native code behind it.
        faulthandler.enable(sys.stderr)


def _log_end(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
    if issubclass(kind, KeyboardInterrupt):
        sys.__excepthook__(kind, error, trace)
    else:
        structlog.get_logger().critical(_one_line(kind, error), exc_info=(kind, error, trace))


def _log_end_of_thread(end: threading.ExceptHookArgs) -> None:
    error = end.exc_value or end.exc_type()
    name = end.thread.name if end.thread is not None else "?"
    structlog.get_logger().critical(_one_line(end.exc_type, error), thread=name, exc_info=(end.exc_type, error, end.exc_traceback))


def _one_line(kind: type[BaseException], error: BaseException) -> str:
    return f"{kind.__name__}: {error}".splitlines()[0]


def _named(process: str) -> Processor:
    def bind(_logger: object, _method: str, event: EventDict) -> EventDict:
        event["process"] = process
        return event

    return bind


def _line_of_record(_logger: object, _method: str, event: EventDict) -> str:
    now = dt.datetime.now(dt.UTC)
    return encode(record_of(event, str(event["process"]), now)).decode().rstrip("\n")
