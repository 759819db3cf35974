"""Commands for outputs and payload: servo, relay, gripper, winch, motor test, ROI, transition, terminate.

They are the actions of `mav vehicle` with the same words.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.cli.common.errors import CommandError
from mavstack.cli.shell import completion
from mavstack.cli.shell.session import Command
from mavstack.cli.shell.subcommands import run_subcommand
from mavstack.vehicle import CalibrationKind

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from mavstack.cli.shell.session import Session

    Run = Callable[[Session, list[str]], Awaitable[None]]

_YES: Final = frozenset({"-y", "--yes"})


def _action(name: str) -> Run:
    """Return the command that runs an action of `mav vehicle`."""

    async def run(session: Session, words: list[str]) -> None:
        await run_subcommand(session, "vehicle", [name, *_without_set(words)])

    return run


def _confirmed_action(name: str, question: str) -> Run:
    """Return the command that runs an action of `mav vehicle` after a confirmation."""

    async def run(session: Session, words: list[str]) -> None:
        if session.interactive and words and not _YES & set(words):
            if not await session.confirm(question):
                raise CommandError("nothing was sent")
            words = [*words, "--yes"]
        await run_subcommand(session, "vehicle", [name, *words])

    return run


async def terminate(session: Session, words: list[str]) -> None:
    """Run `terminate` or `terminate --yes`."""
    if session.interactive and not words:
        if not await session.confirm(f"stop the motors of vehicle {session.vehicle.system} permanently?"):
            raise CommandError("nothing was sent")
        words = ["--yes"]
    await run_subcommand(session, "vehicle", ["terminate", *words])


def _without_set(words: list[str]) -> list[str]:
    """Return the words without the `set` that MAVProxy's `servo` and `relay` have."""
    return words[1:] if words[:1] == ["set"] else words


COMMANDS: Final = (
    Command(
        "servo", "NUMBER MICROSECONDS", "set the pulse of a servo output (ArduPilot)", _action("servo"),
        examples=("servo 9 1900", "servo set 9 1900"),
    ),
    Command(
        "relay", "NUMBER on|off", "switch a relay (ArduPilot)", _action("relay"), examples=("relay 0 on",),
        complete=completion.by_position(None, completion.choice("on", "off")),
    ),
    Command(
        "actuator", "NUMBER VALUE", "set an actuator output to -1 … 1 (PX4)", _action("actuator"),
        examples=("actuator 1 0.5",),
    ),
    Command(
        "gripper", "grip|release", "close or open the gripper", _action("gripper"),
        examples=("gripper release",), complete=completion.by_position(completion.choice("grip", "release")),
    ),
    Command(
        "winch", "unwind METRES | run METRES_PER_SECOND | relax", "run the winch", _action("winch"),
        examples=("winch unwind 5",),
        complete=completion.by_position(completion.choice("unwind", "run", "relax")),
    ),
    Command(
        "motortest", "NUMBER [--throttle PERCENT] [--duration SECONDS]", "run one motor on the ground",
        _confirmed_action("motor-test", "are the propellers off?"), examples=("motortest 1 --throttle 8",),
        details="ArduPilot counts motors clockwise from the front right one. Ctrl-C stops the motor.",
    ),
    Command(
        "roi", "LAT LON [ALTITUDE] | next | none", "set the place that the gimbal points at", _action("roi"),
        examples=("roi 47.3985 8.5460", "roi none"),
        complete=completion.by_position(completion.choice("next", "none")),
    ),
    Command(
        "transition", "fixed-wing|multicopter", "change a VTOL between hovering and wing",
        _action("transition"), examples=("transition fixed-wing",),
        complete=completion.by_position(completion.choice("fixed-wing", "multicopter")),
    ),
    Command(
        "ekfsource", "1|2|3", "select a set of estimator sources (ArduPilot)", _action("ekf-source"),
        examples=("ekfsource 2",), complete=completion.by_position(completion.choice("1", "2", "3")),
    ),
    Command(
        "calibrate", "[KIND [--cancel]]", "calibrate a sensor, the radio control or the motors",
        _action("calibrate"), examples=("calibrate", "calibrate compass"),
        details="Without a kind it lists the kinds that the vehicle has. Ctrl-C cancels a calibration.",
        complete=completion.by_position(completion.choice(*CalibrationKind), completion.choice("--cancel")),
    ),
    Command(
        "terminate", "[--yes]", "stop the motors permanently, also in flight", terminate,
        examples=("terminate --yes",),
    ),
)  # fmt: skip
