"""What a test wants of a vehicle before it begins, done at once in simulated time.

It is done the way that a ground station would do it, by modes and commands, but without a link.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import ardupilotmega, common
from mavstack.errors import MavstackError
from mavstack.services import Address
from mavstack.services.command import Command, CommandRequest
from mavstack.sim.vehicle_types import Firmware, VehicleType

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.sim.simulation import Simulation
    from mavstack.sim.vehicle import SimulatedVehicle

_LONGEST = 180.0
HEIGHT = 10.0
WING_HEIGHT = 50.0
_NEARLY = 0.9
_GROUND = Address(255, common.MavComponent.MISSIONPLANNER)


def run_until(simulation: Simulation, reached: Callable[[], bool], *, limit: float = _LONGEST) -> None:
    """Let time pass until something is so; raises MavstackError if it is not within `limit` seconds."""
    end = simulation.now + limit
    while not reached():
        if simulation.now > end:
            raise MavstackError(f"it did not come about in {limit:g} simulated seconds")
        simulation.step()


def order(vehicle: SimulatedVehicle, command: int, *params: float, frame: int | None = None) -> int:
    """Have a command carried out as if a ground station had sent it; gives its MAV_RESULT."""
    handler = vehicle.commands.handler_of(command)
    if handler is None:
        return common.MavResult.UNSUPPORTED
    asked = Command.of(command, params, frame)
    outcome = handler(CommandRequest(asked, _GROUND, vehicle.now, 0, raw=b"", addressed=True))
    return int(outcome[0] if isinstance(outcome, tuple) else outcome or common.MavResult.ACCEPTED)


def arm(simulation: Simulation, vehicle: SimulatedVehicle) -> None:
    """Wait until the vehicle may be armed, and arm it."""
    autopilot = vehicle.autopilot
    run_until(simulation, lambda: autopilot.booted and not autopilot.arm())


def take_off(simulation: Simulation, vehicle: SimulatedVehicle, height: float | None = None) -> None:
    """Let a vehicle arm, take off and hold there; what does not fly is armed in a mode of its own."""
    autopilot = vehicle.autopilot
    height = height or (WING_HEIGHT if autopilot.maneuvers.circles else HEIGHT)
    run_until(simulation, lambda: autopilot.has_position)
    if vehicle.firmware is Firmware.ARDUPILOT:
        _take_off_ardupilot(simulation, vehicle, height)
    else:
        _take_off_px4(simulation, vehicle, height)
    if vehicle.type.flies:
        run_until(simulation, lambda: autopilot.altitude >= _NEARLY * height)
    if vehicle.type is VehicleType.PLANE:
        autopilot.enter(autopilot.profile.hold, "in the air")
    vehicle.data_to_send()


def _take_off_ardupilot(simulation: Simulation, vehicle: SimulatedVehicle, height: float) -> None:
    autopilot = vehicle.autopilot
    if vehicle.type is VehicleType.PLANE:
        vehicle.parameters.set("TKOFF_ALT", height)
        autopilot.enter(int(ardupilotmega.PlaneMode.TAKEOFF), "wanted in the air")
        arm(simulation, vehicle)
        return
    arm(simulation, vehicle)
    autopilot.enter(autopilot.profile.guided, "wanted in the air")
    if vehicle.type.flies:
        order(vehicle, common.MavCmd.NAV_TAKEOFF, 0, 0, 0, 0, 0, 0, height)


def _take_off_px4(simulation: Simulation, vehicle: SimulatedVehicle, height: float) -> None:
    autopilot = vehicle.autopilot
    nothing = float("nan")
    arm(simulation, vehicle)
    if vehicle.type.flies:
        altitude = height + vehicle.body.frame.to_global(*autopilot.home_position)[2]
        order(vehicle, common.MavCmd.NAV_TAKEOFF, nothing, 0, 0, nothing, nothing, nothing, altitude)
