"""A simulated vehicle that MAVSDK flies over UDP: both in one block, in time that goes faster than clocks."""

from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager, contextmanager
from math import hypot

import pytest

from mavstack.dialects import common
from mavstack.sim import Simulation
from mavstack.sim.runner import Runner
from tests.interop.mavsdk_peer import MavsdkError, made, mavsdk_peer

#: How much faster than the clock: a minute of flight in five seconds.
SPEED = 12.0
#: No part of a flight takes longer, in simulated seconds.
LONGEST = 240.0
POLL = 0.02


class Flight:
    """A vehicle and MAVSDK as its ground station."""

    def __init__(self, vehicle, ground, runner: Runner, running: asyncio.Task) -> None:
        self.vehicle, self.ground, self.runner = vehicle, ground, runner
        self.texts: list[str] = []
        self._running = running
        vehicle.listeners.append(self._listen)

    def _listen(self, vehicle, kind: str, text: str) -> None:
        if kind == "text":
            self.texts.append(text)

    async def call(self, plugin: str, method: str, *arguments):
        """Call a method of a plugin."""
        return await self.ground.call(plugin, method, *arguments)

    async def does(self, plugin: str, method: str, *arguments) -> None:
        """Call one that succeeds."""
        assert await self.ground.call(plugin, method, *arguments) == "SUCCESS"

    async def refuses(self, why: str, plugin: str, method: str, *arguments) -> None:
        """Call one that fails with this result."""
        with pytest.raises(MavsdkError, match=why):
            await self.ground.call(plugin, method, *arguments)

    async def hears(self, name: str, *wanted):
        """Wait until telemetry of this kind is as wanted, one after the other; gives the last."""
        stream = await self.ground.stream("telemetry", f"subscribe_{name}")
        return [await stream.until(each if callable(each) else each.__eq__) for each in wanted][-1]

    async def until(self, condition, within: float = LONGEST) -> None:
        """Wait until something is so in the simulation."""
        end = self.vehicle.now + within
        while not condition():
            if self._running.done():
                self._running.result()
            assert self.vehicle.now < end, self.state
            await asyncio.sleep(POLL)

    async def fly(self, seconds: float) -> None:
        """Let simulated time pass."""
        end = self.vehicle.now + seconds
        await self.until(lambda: self.vehicle.now >= end)

    @contextmanager
    def by_the_clock(self):
        """Plans are sent at the clock's pace: MAVSDK gives up if it is asked for an item too often."""
        speed, self.runner.speed = self.runner.speed, 1.0
        yield
        self.runner.speed = speed

    @property
    def state(self) -> str:
        """What the vehicle is doing, for people."""
        autopilot, here = self.vehicle.autopilot, self.vehicle.body.truth
        return (
            f"{autopilot.mode.name}, {'armed' if autopilot.armed else 'disarmed'}, north {here.north:.1f}, "
            f"east {here.east:.1f}, up {-here.down:.1f}; said {self.texts[-8:]}"
        )

    # Where it is

    @property
    def height(self) -> float:
        """Above the ground, in metres."""
        return -self.vehicle.body.truth.down

    @property
    def speed(self) -> float:
        """Over ground."""
        return hypot(self.vehicle.body.truth.velocity_north, self.vehicle.body.truth.velocity_east)

    def distance(self, north: float = 0.0, east: float = 0.0) -> float:
        """From a point over the ground, in metres."""
        here = self.vehicle.body.truth
        return hypot(here.north - north, here.east - east)

    def place(self, north: float, east: float, height: float = 0.0) -> tuple[float, float, float]:
        """Degrees and metres above the sea of a point in metres from where it began."""
        return self.vehicle.body.frame.to_global(north, east, -height)


@asynccontextmanager
async def in_flight(kind: str, firmware: str, *, speed: float = SPEED, **parameters):
    """A vehicle with some parameters of its own, and MAVSDK that has discovered it."""
    simulation = Simulation()
    vehicle = simulation.add(kind, firmware)
    for name, value in parameters.items():
        vehicle.parameters.set(name, value)
    async with Runner(simulation, speed=speed) as runner:
        link = await runner.connect("udpin://127.0.0.1:0", [vehicle])
        running = runner.start()
        async with mavsdk_peer(f"udpout://127.0.0.1:{link.address[1]}") as ground:
            yield Flight(vehicle, ground, runner, running)
        if running.done():
            running.result()


def raw_items(flight: Flight, *items: tuple) -> list[dict]:
    """A mission for MAVSDK: of each item the command, metres north, east and up, and perhaps param 1."""
    return [
        made(
            "mission_raw.MissionItem",
            seq=seq,
            frame=int(common.MavFrame.GLOBAL_RELATIVE_ALT_INT),
            command=int(command),
            current=int(seq == 0),
            autocontinue=1,
            param1=param1,
            x=round(flight.place(north, east)[0] * 1e7),
            y=round(flight.place(north, east)[1] * 1e7),
            z=float(height),
            mission_type=0,
        )
        for seq, (command, north, east, height, param1) in enumerate((*item, 0.0)[:5] for item in items)
    ]
