"""Every key expression on the bus. A room is the first level, so that several boxes can share a router."""

ROOM = "gym"


def observation(camera: str) -> str:
    """edge -> fusion"""
    return f"{ROOM}/camera/{camera}/observation"


def control(camera: str) -> str:
    """fusion -> edge"""
    return f"{ROOM}/camera/{camera}/control"


def motion(kind: str) -> str:
    """fusion -> everyone; kind is "live" or "smooth" """
    return f"{ROOM}/motion/{kind}"


def fusion_log() -> str:
    """fusion -> recorder"""
    return f"{ROOM}/fusion/log"


def segment_request() -> str:
    """recorder -> fusion"""
    return f"{ROOM}/fusion/segment"


def lesson_request() -> str:
    """command line -> recorder"""
    return f"{ROOM}/lesson/request"


def feedback() -> str:
    """evaluation -> tablet, fusion (for its log)"""
    return f"{ROOM}/evaluation/feedback"


def activity_request() -> str:
    """tablet, replay -> evaluation"""
    return f"{ROOM}/evaluation/activity"


def pupil_turn() -> str:
    """tablet, replay -> evaluation"""
    return f"{ROOM}/evaluation/pupil"


def pupil_corrections() -> str:
    """tablet -> fusion (for its log), evaluation"""
    return f"{ROOM}/evaluation/corrections"


def attempts_begin() -> str:
    """tablet, replay -> evaluation"""
    return f"{ROOM}/evaluation/begin"


def feedback_request() -> str:
    """tablet -> evaluation"""
    return f"{ROOM}/evaluation/ask"


def remembered_feedback() -> str:
    """evaluation -> tablet"""
    return f"{ROOM}/evaluation/remembered"


def health(process: str) -> str:
    """every process -> everyone"""
    return f"{ROOM}/health/{process}"


def beat(process: str) -> str:
    """processes whose silence is noticed at once -> supervisor

    The payload is the process's id in decimal digits, and " ends" behind it in the last beat of a process that ends of itself.
    """
    return f"{ROOM}/beat/{process}"


def alive(process: str) -> str:
    """liveliness token of a process"""
    return f"{ROOM}/alive/{process}"


def process_of(topic: str) -> str:
    """The process that a topic of health, beats or liveliness is of."""
    return topic.rsplit("/", 1)[-1]


ALL_HEALTH = f"{ROOM}/health/*"
ALL_BEATS = f"{ROOM}/beat/*"
ALL_ALIVE = f"{ROOM}/alive/*"
