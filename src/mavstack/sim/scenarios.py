"""Scenarios that bring a vehicle into a state, such as in the air, as fast as possible in simulated time.

They use modes and commands, as a ground station does, but need no link.
"""

from __future__ import annotations

from math import nan
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

DEFAULT_TIMEOUT = 180.0


class ScenarioTimeout(MavstackError, TimeoutError):  # noqa: N818 (as the other timeouts)
    """A condition was not met in the simulated time that a scenario allows."""


#: Default altitudes of a takeoff, in metres: for vehicles that hover and for wings.
DEFAULT_ALTITUDE = 10.0
DEFAULT_WING_ALTITUDE = 50.0
#: Share of the requested altitude from which a takeoff counts as complete.
_REACHED = 0.9
_GROUND_STATION = Address(255, common.MavComponent.MISSIONPLANNER)


def run_until(
    simulation: Simulation, reached: Callable[[], bool], *, timeout: float = DEFAULT_TIMEOUT
) -> None:
    """Run the simulation until a condition is met.

    Args:
        simulation: The simulation.
        reached: The condition, checked before each step.
        timeout: Simulated seconds.

    Raises:
        ScenarioTimeout: The condition was not met in time.
    """
    end = simulation.now + timeout
    while not reached():
        if simulation.now > end:
            raise ScenarioTimeout(f"condition not met within {timeout:g} simulated seconds")
        simulation.step()


def execute_command(vehicle: SimulatedVehicle, command: int, *params: float, frame: int | None = None) -> int:
    """Execute a command as if a ground station had sent it.

    Args:
        vehicle: The vehicle.
        command: The MAV_CMD.
        params: Params 1 to 7; missing ones are 0.
        frame: The MAV_FRAME of a COMMAND_INT; None for a COMMAND_LONG.

    Returns:
        The MAV_RESULT.
    """
    handler = vehicle.commands.handler_of(command)
    if handler is None:
        return common.MavResult.UNSUPPORTED
    request = Command.of(command, params, frame)
    outcome = handler(CommandRequest(request, _GROUND_STATION, vehicle.now, 0, raw=b"", addressed=True))
    return int(outcome[0] if isinstance(outcome, tuple) else outcome or common.MavResult.ACCEPTED)


def arm(simulation: Simulation, vehicle: SimulatedVehicle) -> None:
    """Wait until the vehicle can be armed, and arm it.

    Args:
        simulation: The simulation of the vehicle.
        vehicle: The vehicle.

    Raises:
        ScenarioTimeout: The vehicle could not be armed in time.
    """
    autopilot = vehicle.autopilot
    run_until(simulation, lambda: autopilot.booted and not autopilot.arm())


def take_off(simulation: Simulation, vehicle: SimulatedVehicle, altitude: float | None = None) -> None:
    """Arm a vehicle, take off and hold; a vehicle that cannot fly is only armed.

    Args:
        simulation: The simulation of the vehicle.
        vehicle: The vehicle.
        altitude: Metres above home; None for the default of the vehicle type.

    Raises:
        ScenarioTimeout: The altitude was not reached in time.
    """
    autopilot = vehicle.autopilot
    altitude = altitude or (DEFAULT_WING_ALTITUDE if autopilot.maneuvers.circles else DEFAULT_ALTITUDE)
    run_until(simulation, lambda: autopilot.has_position)
    if vehicle.firmware is Firmware.ARDUPILOT:
        _take_off_ardupilot(simulation, vehicle, altitude)
    else:
        _take_off_px4(simulation, vehicle, altitude)
    if vehicle.vehicle_type.flies:
        run_until(simulation, lambda: autopilot.altitude >= _REACHED * altitude)
    if vehicle.vehicle_type is VehicleType.PLANE:
        autopilot.enter(autopilot.profile.hold, "scenario")
    vehicle.data_to_send()


def _take_off_ardupilot(simulation: Simulation, vehicle: SimulatedVehicle, altitude: float) -> None:
    autopilot = vehicle.autopilot
    if vehicle.vehicle_type is VehicleType.PLANE:
        vehicle.parameters.set("TKOFF_ALT", altitude)
        autopilot.enter(int(ardupilotmega.PlaneMode.TAKEOFF), "scenario")
        arm(simulation, vehicle)
        return
    arm(simulation, vehicle)
    autopilot.enter(autopilot.profile.guided, "scenario")
    if vehicle.vehicle_type.flies:
        execute_command(vehicle, common.MavCmd.NAV_TAKEOFF, 0, 0, 0, 0, 0, 0, altitude)


def _take_off_px4(simulation: Simulation, vehicle: SimulatedVehicle, altitude: float) -> None:
    autopilot = vehicle.autopilot
    arm(simulation, vehicle)
    if vehicle.vehicle_type.flies:
        above_sea = altitude + vehicle.body.frame.to_global(*autopilot.home_position)[2]
        execute_command(vehicle, common.MavCmd.NAV_TAKEOFF, nan, 0, 0, nan, nan, nan, above_sea)
