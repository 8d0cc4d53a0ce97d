"""What is said of the recorder is heard from the recorder alone, whoever else sends a health in its name."""

from models.messages import codec, topics
from models.messages.health import Health, RecorderHealth
from models.process import Delivery
from services.bus.memory import MemoryRouter
from services.doctor.listen import Heard
from services.lesson.remote import Remote

FALSE = Health("recorder", 1, 5, "ok", (), 0.1, 50.0, recorder=RecorderHealth("false", "", 1.0, 1, 0))
TRUE = Health("recorder", 2, 6, "ok", (), 0.1, 50.0, recorder=RecorderHealth("true", "", 1.0, 1, 0))


def test_who_asks_for_a_lesson_hears_the_recorder_and_nobody_in_its_name() -> None:
    router = MemoryRouter()
    box, remote = router.open(), Remote(router.open())
    box.publish(topics.health("edge-cam01"), codec.encode(FALSE))
    box.publish(topics.health("recorder"), codec.encode(TRUE))
    assert remote.listen(5.0) == TRUE
    assert remote.listen(0.0) is None


def test_the_doctor_counts_who_speaks_in_the_recorders_name() -> None:
    heard = Heard()
    heard.take(Delivery(topics.health("recorder"), codec.encode(TRUE)))
    heard.take(Delivery(topics.health("edge-cam01"), codec.encode(FALSE)))
    assert heard.healths == {"recorder": TRUE}
    assert heard.unreadable == {topics.health("edge-cam01"): 1}
