"""Days and times as people read them: in the time zone of this machine, for a lesson's file does not hold that of the gym."""

import datetime as dt


def local_time(since_1970_s: float) -> dt.datetime:
    """Of seconds since 1970 (UTC)."""
    return dt.datetime.fromtimestamp(since_1970_s, tz=dt.UTC).astimezone()
