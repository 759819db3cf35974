"""Commands of the shell run on simulated vehicles in virtual time, without a terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.cli.shell.registry import COMMANDS
from mavstack.cli.shell.runner import run_line
from mavstack.cli.shell.session import Session
from mavstack.links import MemoryNetwork
from mavstack.sim.vehicle_types import VehicleType
from mavstack.sim.virtual import run_virtually
from mavstack.vehicle import connect
from tests.sim.running import reduce_telemetry
from tests.vehicle.world import ARDUPILOT, PX4, fly

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

COPTER, PX4_COPTER = (VehicleType.COPTER, ARDUPILOT), (VehicleType.COPTER, PX4)


def in_shell(kind, scenario: Callable[[Session, object], Awaitable[None]], **how):
    """Run a scenario with a session at a simulated vehicle (the first of several)."""

    async def whole(world, vehicle):
        async with Session(world.node, COMMANDS) as session:
            await scenario(session, world)

    return fly(kind, whole, **{"prepare": reduce_telemetry, **how})


def type_lines(*lines: str, kind=COPTER, **how):
    """Run lines; the first that fails raises."""

    async def scenario(session, world):
        for line in lines:
            await run_line(session, line)

    return in_shell(kind, scenario, **how)


def alone(scenario: Callable[[Session], Awaitable[None]]) -> None:
    """Run a scenario with a session without vehicles."""

    async def whole():
        async with connect(MemoryNetwork().link()) as node, Session(node, COMMANDS) as session:
            await scenario(session)

    run_virtually(whole())
