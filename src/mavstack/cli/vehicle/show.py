"""The actions of `mav vehicle` that show the state of vehicles: info, health, modes."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

from mavstack.cli.common.connection import run_on_connection
from mavstack.cli.common.output import echo, echo_json
from mavstack.cli.common.selection import (
    mention_conflict,
    mention_other_vehicles,
    selected_vehicles,
    selects_several,
)
from mavstack.cli.common.wrapping import terminal_columns
from mavstack.cli.vehicle.info import gather_facts, health_facts, health_lines, page
from mavstack.errors import SystemIdConflictError
from mavstack.services.modes import is_placeholder

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Awaitable, Callable

    from mavstack.vehicle import Connection, Vehicle


def modes(arguments: Namespace) -> int:
    """Run `mav vehicle modes`."""

    async def show(vehicle: Vehicle) -> None:
        listed = await vehicle.modes.list()
        found = [each for each in listed if not is_placeholder(vehicle.autopilot, each.name)]
        rows = [(each.name, each.custom_mode, each.selectable) for each in found]
        if arguments.json:
            keys = ("name", "custom_mode", "selectable")
            modes = [dict(zip(keys, row, strict=True)) for row in rows]
            echo_json({"system": vehicle.system, "mode": vehicle.mode, "modes": modes})
            return
        if selects_several(arguments):
            echo(f"vehicle {vehicle.system}:")
        for name, number, selectable in rows:
            current = "*" if name.lower() == (vehicle.mode or "").lower() else " "
            width = max(len(row[0]) for row in rows)
            echo(f"{current} {name:{width}}  {number}{'' if selectable else '  -'}")

    return _show_each(arguments, show)


def info(arguments: Namespace) -> int:
    """Run `mav vehicle info`."""

    async def show(vehicle: Vehicle) -> None:
        facts = await gather_facts(vehicle)
        if arguments.json:
            echo_json(facts)
        else:
            echo(*page(facts, terminal_columns()))

    return _show_each(arguments, show)


def health(arguments: Namespace) -> int:
    """Run `mav vehicle health`; the exit code is 0 only if all selected vehicles are ready to arm."""
    ready: list[bool] = []

    async def show(vehicle: Vehicle) -> None:
        connection = vehicle.connection
        if arguments.wait:
            await connection.check_sender(vehicle.system, "waiting for the readiness of")
            await vehicle.wait_until_ready(timeout=arguments.wait)
            facts = health_facts(vehicle)
        else:
            with suppress(SystemIdConflictError):  # the conflict is shown as one of the facts
                await connection.check_sender(vehicle.system)
            facts = (await gather_facts(vehicle))["health"]
        # After a successful wait the vehicle is ready, even if it does not report its readiness itself.
        ready.append(facts["ready"] if facts["ready"] is not None else bool(arguments.wait))
        if arguments.json:
            echo_json({"system": vehicle.system, **facts})
            return
        head, *others = health_lines(facts)
        echo(f"vehicle {vehicle.system}: {head}", *(f"  {text}" for text in others))

    return _show_each(arguments, show) or (0 if all(ready) else 1)


def _show_each(arguments: Namespace, show: Callable[[Vehicle], Awaitable[None]]) -> int:
    """Show the selected vehicles one after the other."""

    async def work(connection: Connection) -> int:
        for vehicle in await selected_vehicles(connection, arguments):
            await show(vehicle)
            await mention_conflict(vehicle, arguments)
        if not selects_several(arguments):
            mention_other_vehicles(connection, vehicle, arguments)
        return 0

    return run_on_connection(arguments, work)
