"""The vehicle of `mav demo` that speaks MSP: iNav with a transmitter and a mission, shown through a bridge.

The transmitter arms the vehicle and switches the mission on, which repeats without end. The display sees the
vehicle as any other: the bridge makes a MAVLink vehicle of its flight controller.
"""

from __future__ import annotations

from contextlib import asynccontextmanager
from math import cos, radians, sin
from typing import TYPE_CHECKING, Final

from mavstack.msp import Frame
from mavstack.msp.messages.navigation import LAST_WAYPOINT_FLAG, SetWp, WaypointAction
from mavstack.msp.messages.rc import SetRawRc
from mavstack.sim.motion import LocalFrame
from mavstack.sim.vehicle_types import DEFAULT_HOME, ControllerFirmware, Home

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

    from mavstack.links import MemoryNetwork
    from mavstack.sim.msp import SimulatedFlightController
    from mavstack.sim.runner import Runner
    from mavstack.sim.simulation import Simulation

#: Home of the vehicle in metres north and east of the demo's home; radius and altitude of its polygon.
_PLACE: Final = (-30.0, 60.0)
_RADIUS, _ALTITUDE, _CORNERS = 35.0, 15.0, 3
_LOW, _MIDDLE, _RAISED, _HIGH = 1000, 1500, 1600, 1900
#: Seconds between two frames of the RC transmitter, and times (s) at which it arms and starts the mission.
_INTERVAL: Final = 0.1
_ARMING_TIME, _MISSION_TIME = 3.0, 4.0
_LOW_BATTERY: Final = 0.2
_UNLIMITED: Final = -1


class Transmitter:
    """The pilot of the vehicle: a mission, switches and a throttle.

    Args:
        controller: The flight controller.
    """

    def __init__(self, controller: SimulatedFlightController) -> None:
        self._controller = controller
        self._port = controller.open_port("transmitter")
        self._due = 0.0
        self._write_mission()

    def step(self, elapsed: float) -> None:
        """Send the channels that are due; called before each step of the simulation."""
        if elapsed < self._due:
            return
        self._due = elapsed + _INTERVAL
        throttle = _RAISED if elapsed >= _MISSION_TIME else _LOW
        arm = _HIGH if elapsed >= _ARMING_TIME else _LOW
        mission = _HIGH if elapsed >= _MISSION_TIME else _LOW
        self._send(SetRawRc((_MIDDLE, _MIDDLE, throttle, _MIDDLE, arm, _HIGH, mission, _LOW)))
        if self._controller.body.battery.remaining < _LOW_BATTERY:
            self._controller.faults.inject("battery 100")

    def _write_mission(self) -> None:
        home = self._controller.body.home
        frame = LocalFrame(home.latitude, home.longitude, home.altitude)
        for corner in range(_CORNERS):
            angle = radians(360 * corner / _CORNERS)
            place = frame.to_global(_RADIUS * cos(angle), _RADIUS * sin(angle), 0.0)
            waypoint = SetWp(corner + 1, WaypointAction.WAYPOINT, *place[:2], _ALTITUDE, 0, 0, 0, 0)
            self._send(waypoint)
        jump = SetWp(_CORNERS + 1, WaypointAction.JUMP, 0, 0, 0, 1, _UNLIMITED, 0, LAST_WAYPOINT_FLAG)
        self._send(jump)

    def _send(self, message: SetRawRc | SetWp) -> None:
        frame = Frame(message.COMMAND, message.encode(self._controller.info))
        self._controller.receive(self._port, frame.encode())


def add_racing_drone(simulation: Simulation, field: Home = DEFAULT_HOME) -> SimulatedFlightController:
    """Add the vehicle and its transmitter to a simulation."""
    frame = LocalFrame(field.latitude, field.longitude, field.altitude)
    latitude, longitude, _ = frame.to_global(*_PLACE, 0.0)
    home = Home(latitude, longitude, field.altitude)
    controller = simulation.add_flight_controller(ControllerFirmware.INAV, home=home)
    simulation.before_step.append(Transmitter(controller).step)
    return controller


@asynccontextmanager
async def bridged(
    runner: Runner, controller: SimulatedFlightController, network: MemoryNetwork
) -> AsyncIterator[None]:
    """Show the vehicle as a MAVLink vehicle on a network in memory; the runner must be running meanwhile."""
    from mavstack.bridges.msp import FlightController
    from mavstack.bridges.msp.bridge import MspBridge
    from mavstack.links import memory_pair

    near, far = memory_pair()
    await runner.connect(near, [controller])
    async with (
        FlightController(far) as client,
        MspBridge(client, network.link(), system=controller.address.system),
    ):
        yield
