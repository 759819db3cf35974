"""`commander`: arming, modes, take-off and landing from the shell."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.sim.px4 import modes
from mavstack.sim.px4.arming import arm, disarm, problems_of
from mavstack.sim.px4.mode_selection import choose_mode
from mavstack.sim.px4.movement import change_over
from mavstack.sim.px4.state import BY_SHELL

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from mavstack.sim.px4.shell.machine import Machine

_MODES: Final = MappingProxyType(
    {
        "manual": modes.MANUAL,
        "altctl": modes.ALTITUDE,
        "posctl": modes.POSITION,
        "acro": modes.ACRO,
        "stabilized": modes.STABILIZED,
        "offboard": modes.OFFBOARD,
        "auto:mission": modes.MISSION,
        "auto:loiter": modes.HOLD,
        "auto:rtl": modes.RETURN,
        "auto:takeoff": modes.TAKEOFF,
        "auto:land": modes.LAND,
    }
)
_USAGE: Final = (
    "usage: commander status | check | arm [-f] | disarm [-f] | takeoff | land | transition | termination on",
    f"       commander mode {'|'.join(_MODES)}",
)


def commander(machine: Machine, words: Sequence[str]) -> Iterator[str]:
    """What is done is in the first word."""
    match list(words):
        case ["status"]:
            yield from _status(machine)
        case ["check"]:
            yield from _check(machine)
        case ["mode", name] if name in _MODES:
            yield from _enter(machine, _MODES[name])
        case ["mode", name]:
            yield f"ERROR [commander] argument {name} unsupported."
        case [order, *options] if order in _ORDERS:
            yield from _ORDERS[order](machine, options)
        case _:
            yield from _USAGE


def _check(machine: Machine) -> Iterator[str]:
    problems = list(problems_of(machine.vehicle.autopilot))
    yield from (f"WARN  [health_and_arming_checks] {problem}" for problem in problems)
    yield f"INFO  [commander] Preflight check: {'FAILED' if problems else 'OK'}"


def _arm(machine: Machine, options: Sequence[str]) -> Iterator[str]:
    arm(machine.vehicle, machine.state, BY_SHELL, force="-f" in options)
    return iter(())


def _disarm(machine: Machine, options: Sequence[str]) -> Iterator[str]:
    disarm(machine.vehicle, machine.state, BY_SHELL, force="-f" in options)
    return iter(())


def _take_off(machine: Machine, options: Sequence[str]) -> Iterator[str]:
    yield from _enter(machine, modes.TAKEOFF)
    arm(machine.vehicle, machine.state, BY_SHELL)


def _land(machine: Machine, options: Sequence[str]) -> Iterator[str]:
    return _enter(machine, modes.LAND)


def _change_over(machine: Machine, options: Sequence[str]) -> Iterator[str]:
    vehicle = machine.vehicle
    if not change_over(vehicle, not vehicle.body.flies_forward):
        yield "WARN  [commander] transition is not possible now"


def _terminate(machine: Machine, options: Sequence[str]) -> Iterator[str]:
    if list(options) == ["on"]:
        machine.vehicle.autopilot.terminate()
    else:
        yield "usage: commander termination on"


_ORDERS: Final[Mapping[str, Callable[[Machine, Sequence[str]], Iterator[str]]]] = MappingProxyType(
    {
        "arm": _arm,
        "disarm": _disarm,
        "takeoff": _take_off,
        "land": _land,
        "transition": _change_over,
        "termination": _terminate,
    }
)


def _enter(machine: Machine, mode: int) -> Iterator[str]:
    refused = choose_mode(machine.vehicle, mode)
    if refused is not None:
        yield f"WARN  [commander] {refused}"


def _status(machine: Machine) -> Iterator[str]:
    vehicle, autopilot = machine.vehicle, machine.vehicle.autopilot
    intended = autopilot.find_mode(vehicle.modes.intended.custom_mode) or autopilot.mode
    yield f"INFO  [commander] {'Armed' if autopilot.armed else 'Disarmed'}"
    yield f"INFO  [commander] navigation mode: {autopilot.mode.name}"
    yield f"INFO  [commander] user intended navigation mode: {intended.name}"
    yield f"INFO  [commander] in failsafe: {'yes' if autopilot.failsafes else 'no'}"
