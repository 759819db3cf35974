"""Setpoints that are sent to a simulated autopilot in guided mode."""

from __future__ import annotations

from mavstack.services import Address
from mavstack.services.setpoints import SetpointReceived
from mavstack.sim.vehicle_types import VehicleType
from tests.sim.autopilot.harness import GUIDED, AutopilotHarness

GROUND = Address(255, 190)


def guided(
    kind: VehicleType = VehicleType.COPTER, height: float = 15.0, **flight_parameters: object
) -> AutopilotHarness:
    """A vehicle in the air, or on its way, in the guided mode."""
    flight = AutopilotHarness(kind, **flight_parameters)
    if kind.flies:
        flight.in_the_air(height)
    else:
        flight.arm()
    flight.enter(GUIDED)
    flight.run(0.2)
    return flight


def send_setpoint(flight: AutopilotHarness, setpoint: object) -> None:
    flight.vehicle.handle_event(SetpointReceived(GROUND, setpoint))


def stream(flight: AutopilotHarness, setpoint: object, seconds: float, rate: float = 10.0) -> None:
    """Repeat a setpoint."""
    for _ in range(round(seconds * rate)):
        send_setpoint(flight, setpoint)
        flight.run(1 / rate)
