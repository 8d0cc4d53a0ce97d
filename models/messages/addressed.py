"""Messages that name whom they are of, and came on the topic of that one: no process may speak in another's name by mistake."""

from models.messages import codec, topics
from models.messages.health import Health
from models.messages.observation import Observation
from models.process import EDGE, process_name


def read_health(topic: str, payload: bytes) -> Health:
    """The health of a delivery; CodecError if it cannot be read or is of another process or camera than the topic's."""
    health = codec.decode(payload, Health)
    if topics.health(health.process) != topic:
        raise codec.CodecError(f"health of process '{health.process[:60]}'")
    if health.camera is not None and process_name(EDGE, health.camera.camera) != health.process:
        raise codec.CodecError(f"health of camera '{health.camera.camera[:60]}'")
    return health


def read_observation(topic: str, payload: bytes) -> Observation:
    """The observation of a delivery; CodecError if it cannot be read or is of another camera than the topic's."""
    observation = codec.decode(payload, Observation)
    if topics.observation(observation.camera) != topic:
        raise codec.CodecError(f"an observation of camera '{observation.camera[:60]}'")
    return observation
