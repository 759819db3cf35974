"""Status texts of ArduPilot: during boot, as the filter converges, and on arming."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot


_INFO = common.MavSeverity.INFO
_IMUS = 2
_MOTOR_TYPES: Final = frozenset({VehicleType.COPTER, VehicleType.SUB})


def armed_text(vehicle_type: VehicleType) -> str:
    """Return the text of arming."""
    return "Arming motors" if vehicle_type in _MOTOR_TYPES else "Throttle armed"


def disarmed_text(vehicle_type: VehicleType) -> str:
    """Return the text of disarming."""
    return "Disarming motors" if vehicle_type in _MOTOR_TYPES else "Throttle disarmed"


class BootTexts:
    """Reports the sensors after boot; one of the autopilot's periodic checks."""

    def __init__(self, autopilot: SimulatedAutopilot) -> None:
        self._autopilot = autopilot
        self._script = self._boot_script()

    def tick(self, now: float) -> None:
        """Run the next step of the script."""
        next(self._script, None)

    def _boot_script(self) -> Iterator[None]:
        """Send the texts of the boot sequence."""
        autopilot = self._autopilot
        self._send_statustext("Calibrating barometer")
        self._send_statustext("Barometer 1 calibration complete")
        if autopilot.vehicle.vehicle_type in (VehicleType.PLANE, VehicleType.VTOL):
            self._send_statustext("Airspeed 1 calibrated")
        self._send_statustext("ArduPilot Ready")
        while not autopilot.booted:
            yield
        for text in ("initialised", "tilt alignment complete", "MAG0 initial yaw alignment complete"):
            self._send_for_each_imu(text)
        yield
        while not autopilot.has_position:
            yield
        self._send_statustext("GPS 1: detected u-blox")
        self._send_for_each_imu("origin set")
        while autopilot.home is None:
            yield
        self._send_statustext(f"Field Elevation Set: {autopilot.home.altitude:.0f}m")
        uses_gps = False
        while True:
            if autopilot.has_position and not uses_gps:
                uses_gps = True
                self._send_for_each_imu("is using GPS")
            elif uses_gps and not autopilot.has_position:
                uses_gps = False
                self._send_for_each_imu("stopped aiding")
            yield

    def _send_for_each_imu(self, text: str) -> None:
        """Send a text for each IMU."""
        for number in range(_IMUS):
            self._send_statustext(f"EKF3 IMU{number} {text}")

    def _send_statustext(self, text: str) -> None:
        """Send a status text."""
        self._autopilot.vehicle.send_statustext(text, _INFO)
