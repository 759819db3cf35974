"""Programs of the shell: each gets its arguments and yields lines of output."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, TypeAlias

from mavstack.sim.px4.failures import TYPES, UNITS, faults_for, inject
from mavstack.sim.px4.identity import GIT_HASH, HARDWARE, OPERATING_SYSTEM, VERSION
from mavstack.sim.px4.shell.commander import commander
from mavstack.sim.px4.shell.context import ShellContext
from mavstack.sim.px4.shell.listener import listener
from mavstack.sim.px4.shell.parameters import param

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

__all__ = ["PROGRAMS", "ShellContext"]

Program: TypeAlias = "Callable[[ShellContext, Sequence[str]], Iterator[str]]"

#: Tasks: name, priority, used stack, stack size, processor load in percent.
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


def show_help(context: ShellContext, words: Sequence[str]) -> Iterator[str]:
    """List the programs."""
    yield "Programs of this shell:"
    yield from (f"  {name}" for name in sorted(PROGRAMS))


def ver(context: ShellContext, words: Sequence[str]) -> Iterator[str]:
    """Print versions."""
    serial = context.vehicle.serial.hex().rjust(32, "0")
    lines = {
        "hw": f"HW arch: {HARDWARE}",
        "git": f"PX4 git-hash: {GIT_HASH}",
        "px4": f"PX4 version: Release {VERSION} ({VERSION.pack()})",
        "os": f"OS version: Release {OPERATING_SYSTEM} ({OPERATING_SYSTEM.pack()})",
        "type": f"Vehicle: {context.vehicle.vehicle_type}",
        "px4guid": f"PX4GUID: {serial}",
    }
    selected = words[0] if words else ""
    if selected != "all" and selected not in lines:
        yield f"usage: ver all|{'|'.join(lines)}"
    yield from (line for name, line in lines.items() if selected in (name, "all"))


def uptime(context: ShellContext, words: Sequence[str]) -> Iterator[str]:
    """Print the time since boot."""
    minutes, seconds = divmod(int(context.vehicle.uptime), 60)
    yield f"up {minutes // 60}:{minutes % 60:02d}:{seconds:02d}, boot {context.vehicle.boots}"


def dmesg(context: ShellContext, words: Sequence[str]) -> Iterator[str]:
    """Print the status texts since boot."""
    yield from context.message_log.lines


def top(context: ShellContext, words: Sequence[str]) -> Iterator[str]:
    """Print invented tasks: a simulated vehicle has none."""
    yield " PID COMMAND                   CPU(%)    USED/STACK PRIO"
    for number, (name, priority, used, stack, share) in enumerate(_TASKS):
        yield f"{number:4d} {name:<25}{share:7.1f} {used:7d}/{stack:5d} {priority:4d}"
    yield f"Uptime: {context.vehicle.uptime:.3f}s total"


def free(context: ShellContext, words: Sequence[str]) -> Iterator[str]:
    """Print invented memory use."""
    used = sum(stack for _, _, _, stack, _ in _TASKS) + 96_000
    yield "       total     used     free"
    yield f"{_MEMORY:12d} {used:8d} {_MEMORY - used:8d}"


def logger(context: ShellContext, words: Sequence[str]) -> Iterator[str]:
    """Print whether a log is open."""
    if list(words) != ["status"]:
        yield "usage: logger status"
        return
    yield f"INFO  [logger] {'Logging' if context.vehicle.autopilot.armed else 'Not logging'}"


def failure(context: ShellContext, words: Sequence[str]) -> Iterator[str]:
    """Inject a failure: `failure gps off [-i NUMBER]`."""
    if not int(context.vehicle.parameters["SYS_FAILURE_EN"]):
        yield "ERROR [failure] Failure injection disabled by SYS_FAILURE_EN param."
        return
    unit, kind = (*words, "", "")[:2]
    instance = int(words[3]) if len(words) > 3 and words[2] == "-i" and words[3].isdigit() else 0
    if unit not in UNITS:
        yield f"ERROR [failure] Component '{unit}' not found"
    elif kind not in TYPES:
        yield f"ERROR [failure] Failure type '{kind}' not found"
    elif not faults_for(context.vehicle, UNITS[unit], TYPES[kind], instance):
        yield "ERROR [failure] Result: 3"
    else:
        inject(context.vehicle, UNITS[unit], TYPES[kind], instance)


def reboot(context: ShellContext, words: Sequence[str]) -> Iterator[str]:
    """Reboot after the answer was sent."""
    context.vehicle.autopilot.tasks.on_next_tick(context.vehicle.reboot)
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
