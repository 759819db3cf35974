"""Scripts of flights without a mission, run side by side with a vehicle each.

    @script("copter")
    async def copter_returns(pilot: Pilot) -> None:
        await pilot.take_off(10)
        ...

A script runs with both firmwares unless it names one. Each script is one test.
"""

from __future__ import annotations

import asyncio
import traceback
from dataclasses import dataclass
from math import dist, hypot, inf, nan
from typing import TYPE_CHECKING

import pytest

from mavstack.dialects import common
from mavstack.sim.motion import LocalFrame
from mavstack.sim.simulation import Simulation
from mavstack.sim.vehicle_types import DEFAULT_HOME, Firmware, VehicleType
from mavstack.sim.virtual import run_virtually
from tests.sim.running import reduce_telemetry
from tests.sim.whole_flights.fleet import station

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from mavstack.node import RemoteComponent
    from mavstack.services.setpoints import Setpoint
    from mavstack.sim.motion import Motion
    from mavstack.sim.vehicle import SimulatedVehicle
    from tests.sim.whole_flights.ground_station import Journal, Station

CMD = common.MavCmd
_FRAME = LocalFrame(*DEFAULT_HOME[:3])
#: Steps per second: half the default, since there are many vehicles.
RATE = 25.0
PX4, ARDUPILOT = Firmware.PX4, Firmware.ARDUPILOT


class Pilot:
    """The pilot of one vehicle, by MAVLink."""

    def __init__(self, ground: Station, remote: RemoteComponent, vehicle: SimulatedVehicle) -> None:
        self.ground, self.remote, self.vehicle = ground, remote, vehicle
        self.journal: Journal = ground.journal(vehicle.address.system)

    # State: the journal holds the messages, `truth` the true motion

    @property
    def px4(self) -> bool:
        return self.vehicle.firmware is PX4

    @property
    def mode(self) -> str:
        return str(self.vehicle.autopilot.mode.name).upper()

    @property
    def truth(self) -> Motion:
        return self.vehicle.body.truth

    @property
    def height(self) -> float:
        return -self.truth.down

    def distance_from(self, north: float = 0.0, east: float = 0.0) -> float:
        return hypot(self.truth.north - north, self.truth.east - east)

    @property
    def speed(self) -> float:
        return dist(self.truth[3:6], (0, 0, 0))

    def has_text(self, start: str) -> bool:
        return any(text.startswith(start) for text in self.journal.texts)

    async def wait_until(
        self, condition: Callable[[], bool], description: str, timeout: float = 60.0
    ) -> None:
        await self.ground.wait_until(
            condition, f"{description}; mode {self.mode} at {self.truth[:3]}", timeout
        )

    async def wait(self, seconds: float) -> None:
        await asyncio.sleep(seconds)

    # Actions

    async def command(self, command: int, *params: float, frame: int | None = None) -> None:
        await self.remote.command(command, *params, frame=frame)

    async def set_mode(self, *names: str) -> None:
        """Set a mode by its name in ArduPilot, or in PX4."""
        await self.remote.modes.set(names[-1] if self.px4 else names[0])

    async def take_off(self, height: float) -> None:
        await self.wait_until(lambda: self.journal.ready, "ready", 30)
        if self.px4:
            await self.command(CMD.NAV_TAKEOFF, nan, 0, 0, nan, nan, nan, DEFAULT_HOME.altitude + height)
            await self.command(CMD.COMPONENT_ARM_DISARM, 1)
        elif self.vehicle.vehicle_type is VehicleType.PLANE:
            await self.remote.params.set("TKOFF_ALT", height)
            await self.set_mode("TAKEOFF")
            await self.command(CMD.COMPONENT_ARM_DISARM, 1)
        else:
            await self.set_mode("GUIDED")
            await self.command(CMD.COMPONENT_ARM_DISARM, 1)
            await self.command(CMD.NAV_TAKEOFF, 0, 0, 0, 0, 0, 0, height)
        slow = inf if self.vehicle.vehicle_type is VehicleType.PLANE else 0.5
        await self.wait_until(
            lambda: self.height > 0.9 * height and self.speed < slow, "at take-off altitude"
        )

    async def go_to(self, north: float, east: float, height: float) -> None:
        """Go to a point by DO_REPOSITION."""
        latitude, longitude, altitude = _FRAME.to_global(north, east, -height)
        change = common.MavDoRepositionFlags.CHANGE_MODE
        params = (-1, change, 0, nan, latitude, longitude, altitude)
        await self.command(CMD.DO_REPOSITION, *params, frame=common.MavFrame.GLOBAL)

    async def follow(self, setpoint: Setpoint, seconds: float) -> None:
        """Stream a setpoint, in the mode that follows it."""
        async with self.remote.setpoints(rate=10) as stream:
            stream.set(setpoint)
            await asyncio.sleep(0.5)
            await self.set_mode("GUIDED", "OFFBOARD")
            await asyncio.sleep(seconds)


@dataclass(frozen=True)
class Script:
    """A script and its vehicle."""

    name: str
    kind: VehicleType
    firmware: Firmware
    fly: Callable[[Pilot], Awaitable[None]]


SCRIPTS: list[Script] = []


def script(kind: str, *firmwares: Firmware) -> Callable[..., Callable[[Pilot], Awaitable[None]]]:
    """Register a coroutine function as a script."""

    def add(fly: Callable[[Pilot], Awaitable[None]]) -> Callable[[Pilot], Awaitable[None]]:
        for firmware in firmwares or tuple(Firmware):
            name = f"{fly.__name__}-{kind}-{firmware}"
            SCRIPTS.append(Script(name, VehicleType(kind), firmware, fly))
        return fly

    return add


def fly_scripts() -> dict[str, str]:
    """Run all scripts; return the traceback of each, empty if it passed."""
    simulation, outcomes = Simulation(seed=11, rate=RATE), {}
    vehicles = [simulation.add(each.kind, each.firmware) for each in SCRIPTS]
    for vehicle in vehicles:
        reduce_telemetry(vehicle)

    async def fly(ground: Station, each: Script, vehicle: SimulatedVehicle) -> None:
        try:
            remote = await ground.node.wait_for_autopilot(vehicle.address.system)
            await each.fly(Pilot(ground, remote, vehicle))
            outcomes[each.name] = ""
        except (Exception, pytest.fail.Exception):  # noqa: BLE001 (reported by its test)
            outcomes[each.name] = traceback.format_exc(limit=-4)

    async def run_all() -> None:
        async with station(simulation) as ground, asyncio.TaskGroup() as group:
            for each, vehicle in zip(SCRIPTS, vehicles, strict=True):
                group.create_task(fly(ground, each, vehicle))

    run_virtually(run_all())
    return outcomes
