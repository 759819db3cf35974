"""`mav vehicle failure`: a unit of a vehicle that fails on purpose, for tests of failsafes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.cli.common.confirmation import add_yes_option, is_confirmed
from mavstack.cli.common.errors import UsageError
from mavstack.cli.vehicle.arguments import add_timed
from mavstack.cli.vehicle.outcomes import run_on_vehicles
from mavstack.node.failure import MAX_INSTANCE, failure_types, failure_units

if TYPE_CHECKING:
    from argparse import Namespace

    from mavstack.cli.common.actions import Actions
    from mavstack.vehicle import Vehicle

#: The way to fail that ends a failure.
_END: Final = "ok"


def add_actions(actions: Actions) -> None:
    """Declare the action."""
    summary = "make a unit fail on purpose, for a test of a failsafe (PX4)"
    action = add_timed(actions, "failure", summary, failure, fleet=False)
    action.add_argument("unit", choices=failure_units(), metavar="UNIT", help=", ".join(failure_units()))
    action.add_argument(
        "how", nargs="?", choices=failure_types(), default="off", metavar="HOW",
        help=f"{', '.join(failure_types())}; ok ends the failure (default: off)",
    )  # fmt: skip
    action.add_argument(
        "--number", type=int, default=0, metavar="N", help="number of the unit, from 1 (default: all of them)"
    )
    add_yes_option(action)


def failure(arguments: Namespace) -> int:
    """Run `mav vehicle failure`."""
    if not 0 <= arguments.number <= MAX_INSTANCE:
        raise UsageError(f"--number must be from 0 to {MAX_INSTANCE}, got {arguments.number}")
    unit = arguments.unit + (f" {arguments.number}" if arguments.number else "")
    ends = arguments.how == _END
    if not ends and not is_confirmed(arguments, f"make {unit} fail ({arguments.how})", "make a unit fail"):
        return 1

    async def work(vehicle: Vehicle) -> str:
        await vehicle.failure.inject(
            arguments.unit, arguments.how, arguments.number, timeout=arguments.action_timeout
        )
        return f"{unit} works again" if ends else f"{unit} fails: {arguments.how}"

    return run_on_vehicles(arguments, work)
