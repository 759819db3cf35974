"""Arguments that the actions of `mav vehicle` share: `--action-timeout`, `--no-wait`, a place."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.cli.common.connection import add_vehicle_action
from mavstack.cli.common.options import finite_number, seconds

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Callable

    from mavstack.cli.common.actions import Actions


def add_action(
    actions: Actions, name: str, summary: str, run_action: Callable[[Namespace], int]
) -> ArgumentParser:
    """Add an action that changes nothing."""
    return add_vehicle_action(actions, name, summary, run_action, fleet=True)


def add_timed(
    actions: Actions, name: str, summary: str, run_action: Callable[[Namespace], int], *, fleet: bool = True
) -> ArgumentParser:
    """Add an action that changes something; without `fleet`, on one vehicle only."""
    parser = add_vehicle_action(actions, name, summary, run_action, fleet=fleet, changes=True)
    parser.add_argument(
        "--action-timeout", type=seconds, metavar="SECONDS", help="fail if the action takes longer"
    )
    return parser


def add_flight(
    actions: Actions, name: str, summary: str, run_action: Callable[[Namespace], int]
) -> ArgumentParser:
    """Add an action that goes on after the vehicle has accepted it."""
    parser = add_timed(actions, name, summary, run_action)
    parser.add_argument(
        "--no-wait", dest="wait", action="store_false", help="end when the vehicle has accepted the action"
    )
    return parser


def add_override(parser: ArgumentParser) -> None:
    """Declare `--override-limits`."""
    parser.add_argument(
        "--override-limits",
        action="store_true",
        help="accept a target beyond the limits of plausible flights",
    )


def add_tolerance(parser: ArgumentParser) -> None:
    """Declare `--tolerance`."""
    parser.add_argument(
        "--tolerance",
        type=finite_number,
        metavar="M",
        help="metres from the target at which the vehicle has arrived (default: by its type)",
    )


def add_place(parser: ArgumentParser) -> None:
    """Declare the place that an action flies to, `--tolerance` and `--override-limits`."""
    add_override(parser)
    add_tolerance(parser)
    parser.add_argument("latitude", type=finite_number, metavar="LAT", help="degrees")
    parser.add_argument("longitude", type=finite_number, metavar="LON", help="degrees")
    parser.add_argument(
        "altitude",
        nargs="?",
        type=finite_number,
        metavar="ALTITUDE",
        help="metres above home (default: the current altitude)",
    )
