"""Key expressions: which topics a subscription means.

Source: Zenoh's key expression language (https://zenoh.io/docs/manual/abstractions), of which this box uses two wildcards: `*` is
any one chunk of a topic, `**` any number of them, also none.
"""

from functools import lru_cache


@lru_cache(maxsize=4096)
def matches(pattern: str, topic: str) -> bool:
    """Whether `topic`, which has no wildcards, is one that `pattern` means."""
    return _match(tuple(pattern.split("/")), tuple(topic.split("/")))


def _match(pattern: tuple[str, ...], topic: tuple[str, ...]) -> bool:
    if not pattern:
        return not topic
    if pattern[0] == "**":
        return _match(pattern[1:], topic) or (bool(topic) and _match(pattern, topic[1:]))
    return bool(topic) and pattern[0] in ("*", topic[0]) and _match(pattern[1:], topic[1:])
