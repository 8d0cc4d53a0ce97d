"""The whole examination, one part after the other. A part that cannot be examined does not keep the others from it."""

import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from models.config.site import Site
from models.inspection import Inspection
from services.doctor.configuration import (
    Configuration,
    gather_configuration,
    gather_inspected,
    judge_configuration,
    judge_inspected,
)
from services.doctor.finding import Examined, Fact, Finding
from services.doctor.installation import Installation, gather_installation, judge_installation
from services.doctor.lessons import gather_lessons, judge_lessons
from services.doctor.machine import gather_machine, judge_machine
from services.doctor.ports import gather_ports, judge_ports
from services.doctor.processes import RunningBox, gather_boxes
from services.support.machine import Sensors
from services.support.version import kinebox_version


@dataclass(frozen=True)
class Order:
    """What to examine, and with what.

    Attributes:
        site: the site file; None examines the machine and the installation alone.
        data: the data folder.
        inspections: what the parts look at themselves.
        sensors: what the machine is measured with.
        installation: looks at what was installed, given the data folder.
    """

    site: Path | None
    data: Path
    inspections: Iterable[Inspection] = ()
    sensors: Sensors = field(default_factory=Sensors)
    installation: Callable[[Path], Installation] = gather_installation


def examine(order: Order) -> Examined:
    """Everything, the worst first."""
    return Examined.join(_parts(order))


def _parts(order: Order) -> Iterator[Examined]:
    yield judge_machine(gather_machine(order.data, order.sensors))
    yield judge_installation(order.installation(order.data))
    configuration = gather_configuration(order.site)
    yield judge_configuration(configuration)
    if not configuration.error:  # Else nobody knows where lessons shall be.
        yield judge_lessons(gather_lessons(configuration.site, order.data, order.sensors.free_disk_mib))
    yield judge_inspected(gather_inspected(configuration, order.data, order.inspections))
    yield from _running(order, configuration)


def _running(order: Order, configuration: Configuration) -> Iterator[Examined]:
    boxes = gather_boxes()
    own = next((box for box in boxes if order.site is not None and box.site == order.site.resolve()), None)
    if configuration.site is None:
        if boxes and configuration.error:
            words = "not examined, since the site file that was named cannot be used; first do what is found of it"
            yield Examined(facts=(Fact("running box", words),))
        elif boxes:
            sites = ", ".join(str(box.site) for box in boxes)
            yield Examined(facts=(Fact("running box", f"not examined; name its site file with --site ({sites})"),))
        return
    yield judge_ports(gather_ports(configuration.site, own, boxes))
    if own is None:
        yield Examined(facts=(Fact("running box", "none of this site"),))
    else:
        yield _box(order, configuration.site, own)


def _box(order: Order, site: Site, own: RunningBox) -> Examined:
    try:
        from services.doctor.box import SUPERVISOR, BoxFacts, judge_box  # noqa: PLC0415 - needs packages that may be what is broken
        from services.doctor.listen import listen  # noqa: PLC0415
        from services.supervisor.supervise import posts_of  # noqa: PLC0415
    except ImportError as error:
        remedy = "see what is found of the packages"
        return Examined((Finding("fault", "running box", f"it cannot be listened to: {error}", "joining its bus", remedy),))
    expected = (*(post.name for post in posts_of(site)), SUPERVISOR)
    heard = listen(site, frozenset(expected))
    return judge_box(BoxFacts(site, order.data, own, expected, heard, kinebox_version(), time.monotonic_ns()))
