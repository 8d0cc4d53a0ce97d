"""What is wrong with a machine, from what was measured of it. Pure."""

from models.messages.health import MachineHealth
from models.messages.trouble import MachineCode, Trouble
from services.support.amount import megabytes, size_of

DISK_FULL_MB = 200.0
"""A lesson of 45 minutes takes up to 150 MB (`make bench-lessons`), and others write beside it."""
DISK_LOW_MB = 2000.0
"""Room for a dozen lessons."""
MEMORY_LOW_MIB = 250.0
"""About what one process of the box needs to be started again."""
HOT_C = 90.0
"""Processors for small boxes end or slow down at 85 to 105 °C; one that slows down earlier says so by itself."""


def machine_troubles(machine: MachineHealth) -> tuple[Trouble, ...]:
    """Everything wrong with a machine, worst first. A figure that is not known (NaN) is no trouble."""
    disk_free_mb = megabytes(machine.disk_free_mib)
    found: list[tuple[bool, Trouble]] = [
        (disk_free_mb < DISK_FULL_MB, _disk(machine, "disk_full", "is full")),
        (DISK_FULL_MB <= disk_free_mb < DISK_LOW_MB, _disk(machine, "disk_low", "is nearly full")),
        (machine.memory_free_mib < MEMORY_LOW_MIB, _memory(machine)),
        (machine.temperature_c is not None and machine.temperature_c >= HOT_C, _heat(machine)),
        (machine.throttled, _throttled(machine)),
        (machine.clock_step_ms != 0, _clock(machine)),
    ]
    return tuple(trouble for present, trouble in found if present)


def _disk(machine: MachineHealth, code: MachineCode, how: str) -> Trouble:
    words = f"the disk of the data folder {how}: {size_of(machine.disk_free_mib)} are free"
    remedy = f"delete old lessons or other files on it until {DISK_LOW_MB / 1000:.1f} GB are free, or use a larger disk"
    return Trouble(code, words, remedy)


def _memory(machine: MachineHealth) -> Trouble:
    words = f"memory is nearly gone: {size_of(machine.memory_free_mib)} are free"
    return Trouble("memory_low", words, "end other programs on this machine, or give it more memory")


def _heat(machine: MachineHealth) -> Trouble:
    words = f"the processor is too hot: {machine.temperature_c or 0.0:.0f} °C"
    return Trouble("hot", words, "free the box's openings, clean its fan, and keep it out of the sun")


def _throttled(machine: MachineHealth) -> Trouble:
    at = "" if machine.temperature_c is None else f" (it is at {machine.temperature_c:.0f} °C)"
    words = f"the processor was slowed down in the last minute, for its heat or for want of power{at}"
    return Trouble("throttled", words, "cool the box, and use the power supply that belongs to it")


def _clock(machine: MachineHealth) -> Trouble:
    seconds = machine.clock_step_ms * 1e-3
    words = f"the clock was set {'forwards' if seconds > 0 else 'back'} by {abs(seconds):.1f} s in the last minute"
    remedy = "no figure is wrong by it, but the times in logs and of lessons jump; let a time service keep the clock"
    return Trouble("clock_set", words, remedy)
