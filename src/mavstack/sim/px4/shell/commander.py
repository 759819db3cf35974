"""`commander`: arming, modes, take-off and landing from the shell."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.sim.px4 import modes
from mavstack.sim.px4.arming import arm, disarm, preflight_problems
from mavstack.sim.px4.mode_selection import choose_mode
from mavstack.sim.px4.movement import start_transition
from mavstack.sim.px4.state import BY_SHELL

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from mavstack.sim.px4.shell.context import ShellContext

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


def commander(context: ShellContext, words: Sequence[str]) -> Iterator[str]:
    """Run the subcommand in the first word."""
    match list(words):
        case ["status"]:
            yield from _status(context)
        case ["check"]:
            yield from _check(context)
        case ["mode", name] if name in _MODES:
            yield from _enter(context, _MODES[name])
        case ["mode", name]:
            yield f"ERROR [commander] argument {name} unsupported."
        case [command, *options] if command in _COMMANDS:
            yield from _COMMANDS[command](context, options)
        case _:
            yield from _USAGE


def _check(context: ShellContext) -> Iterator[str]:
    """Run the preflight checks."""
    problems = list(preflight_problems(context.vehicle.autopilot))
    yield from (f"WARN  [health_and_arming_checks] {problem}" for problem in problems)
    yield f"INFO  [commander] Preflight check: {'FAILED' if problems else 'OK'}"


def _arm(context: ShellContext, options: Sequence[str]) -> Iterator[str]:
    """Arm the vehicle."""
    arm(context.vehicle, context.state, BY_SHELL, force="-f" in options)
    return iter(())


def _disarm(context: ShellContext, options: Sequence[str]) -> Iterator[str]:
    """Disarm the vehicle."""
    disarm(context.vehicle, context.state, BY_SHELL, force="-f" in options)
    return iter(())


def _take_off(context: ShellContext, options: Sequence[str]) -> Iterator[str]:
    """Take off."""
    yield from _enter(context, modes.TAKEOFF)
    arm(context.vehicle, context.state, BY_SHELL)


def _land(context: ShellContext, options: Sequence[str]) -> Iterator[str]:
    """Land."""
    return _enter(context, modes.LAND)


def _transition(context: ShellContext, options: Sequence[str]) -> Iterator[str]:
    """Start a transition."""
    vehicle = context.vehicle
    if not start_transition(vehicle, not vehicle.body.flies_forward):
        yield "WARN  [commander] transition is not possible now"


def _terminate(context: ShellContext, options: Sequence[str]) -> Iterator[str]:
    """Terminate the flight."""
    if list(options) == ["on"]:
        context.vehicle.autopilot.terminate()
    else:
        yield "usage: commander termination on"


_COMMANDS: Final[Mapping[str, Callable[[ShellContext, Sequence[str]], Iterator[str]]]] = MappingProxyType(
    {
        "arm": _arm,
        "disarm": _disarm,
        "takeoff": _take_off,
        "land": _land,
        "transition": _transition,
        "termination": _terminate,
    }
)


def _enter(context: ShellContext, mode: int) -> Iterator[str]:
    """Enter a mode."""
    refused = choose_mode(context.vehicle, mode)
    if refused is not None:
        yield f"WARN  [commander] {refused}"


def _status(context: ShellContext) -> Iterator[str]:
    """Print arming state and modes."""
    vehicle, autopilot = context.vehicle, context.vehicle.autopilot
    intended = autopilot.find_mode(vehicle.modes.intended.custom_mode) or autopilot.mode
    yield f"INFO  [commander] {'Armed' if autopilot.armed else 'Disarmed'}"
    yield f"INFO  [commander] navigation mode: {autopilot.mode.name}"
    yield f"INFO  [commander] user intended navigation mode: {intended.name}"
    yield f"INFO  [commander] in failsafe: {'yes' if autopilot.failsafes else 'no'}"
