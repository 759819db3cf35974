"""A simulated vehicle that MAVSDK flies over UDP, faster than real time."""

from __future__ import annotations

from contextlib import asynccontextmanager, contextmanager
from math import hypot

import pytest

from mavstack.dialects import common
from mavstack.sim import Simulation
from tests.interop.mavsdk_peer import MavsdkError, mavsdk_object, mavsdk_peer
from tests.sim.running import RunningSimulation, running
from tests.waiting import wait_until

#: Simulated seconds per real second: a minute of flight in five seconds.
SPEED = 12.0
#: Timeout of one part of a flight, in simulated seconds.
MAX_FLIGHT_TIME = 240.0
POLL_INTERVAL = 0.02


class Flight:
    """A simulated vehicle and MAVSDK as its ground station."""

    def __init__(self, vehicle, ground, simulated: RunningSimulation) -> None:
        self.vehicle, self.ground, self.runner = vehicle, ground, simulated.runner
        self.texts: list[str] = []
        self._simulated = simulated
        vehicle.add_listener(self._on_event)

    def _on_event(self, vehicle, kind: str, text: str) -> None:
        if kind == "text":
            self.texts.append(text)

    async def call(self, plugin: str, method: str, *arguments):
        """Call a method of a MAVSDK plugin."""
        return await self.ground.call(plugin, method, *arguments)

    async def call_ok(self, plugin: str, method: str, *arguments) -> None:
        """Call a method and require success."""
        assert await self.ground.call(plugin, method, *arguments) == "SUCCESS"

    async def call_fails(self, reason: str, plugin: str, method: str, *arguments) -> None:
        """Call a method and require that it fails for a reason."""
        with pytest.raises(MavsdkError, match=reason):
            await self.ground.call(plugin, method, *arguments)

    async def wait_for_telemetry(self, name: str, *expected):
        """Wait for telemetry values (or predicates of them) in this order; return the last value."""
        stream = await self.ground.stream("telemetry", f"subscribe_{name}")
        return [await stream.wait_for(each if callable(each) else each.__eq__) for each in expected][-1]

    async def wait_until(self, condition, timeout: float = MAX_FLIGHT_TIME) -> None:
        """Wait until a condition holds; `timeout` is in simulated seconds."""
        try:
            await wait_until(
                lambda: self._simulated.raise_error() or condition(),
                timeout=timeout,
                interval=POLL_INTERVAL,
                now=lambda: self.vehicle.now,
            )
        except AssertionError as error:
            raise AssertionError(f"{error}: {self.state}") from None

    async def fly(self, seconds: float) -> None:
        """Let this many simulated seconds pass."""
        end = self.vehicle.now + seconds
        await self.wait_until(lambda: self.vehicle.now >= end)

    @contextmanager
    def real_time(self):
        """Run at real time: MAVSDK ends a plan transfer if an item is requested too often."""
        speed, self.runner.speed = self.runner.speed, 1.0
        yield
        self.runner.speed = speed

    @property
    def state(self) -> str:
        """The state of the vehicle, for failure messages."""
        autopilot, here = self.vehicle.autopilot, self.vehicle.body.truth
        return (
            f"{autopilot.mode.name}, {'armed' if autopilot.armed else 'disarmed'}, north {here.north:.1f}, "
            f"east {here.east:.1f}, up {-here.down:.1f}; status texts {self.texts[-8:]}"
        )

    @property
    def can_arm(self) -> bool:
        """True if nothing prevents arming; a fast machine gets that far before the vehicle has booted."""
        autopilot = self.vehicle.autopilot
        return not list(autopilot.profile.arming_problems(autopilot))

    # Position

    @property
    def height(self) -> float:
        """The height above ground, in metres."""
        return -self.vehicle.body.truth.down

    @property
    def speed(self) -> float:
        """The ground speed, in m/s."""
        return hypot(self.vehicle.body.truth.velocity_north, self.vehicle.body.truth.velocity_east)

    def distance(self, north: float = 0.0, east: float = 0.0) -> float:
        """Return the horizontal distance from a point, in metres."""
        here = self.vehicle.body.truth
        return hypot(here.north - north, here.east - east)

    def place(self, north: float, east: float, height: float = 0.0) -> tuple[float, float, float]:
        """Return latitude, longitude (degrees) and altitude (metres AMSL) of a point from the start."""
        return self.vehicle.body.frame.to_global(north, east, -height)


@asynccontextmanager
async def simulated_flight(kind: str, firmware: str, *, speed: float = SPEED, **parameters):
    """Yield a simulated vehicle with these parameters, discovered by MAVSDK."""
    simulation = Simulation()
    vehicle = simulation.add(kind, firmware)
    for name, value in parameters.items():
        vehicle.parameters.set(name, value)
    async with (
        running(simulation, "udpin://127.0.0.1:0", speed=speed) as simulated,
        mavsdk_peer(f"udpout://127.0.0.1:{simulated.link.address[1]}") as ground,
    ):
        yield Flight(vehicle, ground, simulated)


def raw_items(flight: Flight, *items: tuple) -> list[dict]:
    """Return a MAVSDK mission from items of (command, north, east, up[, param1]), in metres."""
    return [
        mavsdk_object(
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
