"""The programs of the shell: each takes its words and yields the lines that it prints."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, TypeAlias

from mavstack.sim.px4.failures import TYPES, UNITS, faults_of, inject
from mavstack.sim.px4.identity import GIT_HASH, HARDWARE, OPERATING_SYSTEM, VERSION
from mavstack.sim.px4.shell.commander import commander
from mavstack.sim.px4.shell.listener import listener
from mavstack.sim.px4.shell.machine import Machine
from mavstack.sim.px4.shell.parameters import param

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

__all__ = ["PROGRAMS", "Machine"]

Program: TypeAlias = "Callable[[Machine, Sequence[str]], Iterator[str]]"

#: A task: name, priority, stack in use, stack, share of the processor.
_TASKS: Final = (
    ("Idle Task", 0, 268, 512, 61.2),
    ("hpwork", 249, 364, 1264, 0.0),
    ("lpwork", 50, 780, 1616, 0.1),
    ("init", 100, 2084, 2924, 0.0),
    ("wq:rate_ctrl", 255, 1420, 3152, 9.4),
    ("wq:nav_and_controllers", 242, 1220, 2280, 5.6),
    ("wq:INS0", 241, 4060, 6000, 8.7),
    ("wq:hp_default", 237, 1020, 2800, 1.2),
    ("commander", 140, 1124, 3224, 1.0),
    ("navigator", 105, 1052, 2104, 0.4),
    ("logger", 230, 2044, 3648, 1.3),
    ("mavlink_if0", 100, 1948, 2824, 4.1),
)
_MEMORY: Final = 262_144


def show_help(machine: Machine, words: Sequence[str]) -> Iterator[str]:
    """Which programs there are."""
    yield "Programs of this shell:"
    yield from (f"  {name}" for name in sorted(PROGRAMS))


def ver(machine: Machine, words: Sequence[str]) -> Iterator[str]:
    """What this is."""
    serial = f"{machine.vehicle.address.system:032x}"
    lines = {
        "hw": f"HW arch: {HARDWARE}",
        "git": f"PX4 git-hash: {GIT_HASH}",
        "px4": f"PX4 version: Release {VERSION} ({VERSION.pack()})",
        "os": f"OS version: Release {OPERATING_SYSTEM} ({OPERATING_SYSTEM.pack()})",
        "type": f"Vehicle: {machine.vehicle.type}",
        "px4guid": f"PX4GUID: {serial}",
    }
    wanted = words[0] if words else ""
    if wanted != "all" and wanted not in lines:
        yield f"usage: ver all|{'|'.join(lines)}"
    yield from (line for name, line in lines.items() if wanted in (name, "all"))


def uptime(machine: Machine, words: Sequence[str]) -> Iterator[str]:
    """How long ago it booted."""
    minutes, seconds = divmod(int(machine.vehicle.uptime), 60)
    yield f"up {minutes // 60}:{minutes % 60:02d}:{seconds:02d}, boot {machine.vehicle.boots}"


def dmesg(machine: Machine, words: Sequence[str]) -> Iterator[str]:
    """What it said since then."""
    yield from machine.journal.lines


def top(machine: Machine, words: Sequence[str]) -> Iterator[str]:
    """Tasks; a simulated vehicle has none, so that the figures are made up."""
    yield " PID COMMAND                   CPU(%)    USED/STACK PRIO"
    for number, (name, priority, used, stack, share) in enumerate(_TASKS):
        yield f"{number:4d} {name:<25}{share:7.1f} {used:7d}/{stack:5d} {priority:4d}"
    yield f"Uptime: {machine.vehicle.uptime:.3f}s total"


def free(machine: Machine, words: Sequence[str]) -> Iterator[str]:
    """Memory, as made up."""
    used = sum(stack for _, _, _, stack, _ in _TASKS) + 96_000
    yield "       total     used     free"
    yield f"{_MEMORY:12d} {used:8d} {_MEMORY - used:8d}"


def logger(machine: Machine, words: Sequence[str]) -> Iterator[str]:
    """Whether a log is written."""
    if list(words) != ["status"]:
        yield "usage: logger status"
        return
    yield f"INFO  [logger] {'Logging' if machine.vehicle.autopilot.armed else 'Not logging'}"


def failure(machine: Machine, words: Sequence[str]) -> Iterator[str]:
    """Let something fail: `failure gps off [-i NUMBER]`."""
    if not int(machine.vehicle.parameters["SYS_FAILURE_EN"]):
        yield "ERROR [failure] Failure injection disabled by SYS_FAILURE_EN param."
        return
    unit, kind = (*words, "", "")[:2]
    instance = int(words[3]) if len(words) > 3 and words[2] == "-i" and words[3].isdigit() else 0
    if unit not in UNITS:
        yield f"ERROR [failure] Component '{unit}' not found"
    elif kind not in TYPES:
        yield f"ERROR [failure] Failure type '{kind}' not found"
    elif not faults_of(machine.vehicle, UNITS[unit], TYPES[kind], instance):
        yield "ERROR [failure] Result: 3"
    else:
        inject(machine.vehicle, UNITS[unit], TYPES[kind], instance)


def reboot(machine: Machine, words: Sequence[str]) -> Iterator[str]:
    """Restart, when what was typed has been answered."""
    machine.vehicle.autopilot.tasks.on_next_tick(machine.vehicle.reboot)
    yield "rebooting"


PROGRAMS: Final[Mapping[str, Program]] = {
    "help": show_help,
    "ver": ver,
    "uptime": uptime,
    "dmesg": dmesg,
    "top": top,
    "free": free,
    "param": param,
    "commander": commander,
    "listener": listener,
    "logger": logger,
    "failure": failure,
    "reboot": reboot,
}
