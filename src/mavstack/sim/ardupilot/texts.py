"""What ArduPilot says by itself: while it starts, as its filter settles, and when the motors are armed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.sim.autopilot.interfaces import Autopilot

_INFO = common.MavSeverity.INFO
_IMUS = 2
_MOTORS: Final = frozenset({VehicleType.COPTER, VehicleType.SUB})


def armed_text(type: VehicleType) -> str:  # noqa: A002 (HEARTBEAT's name for it)
    """When the motors were armed."""
    return "Arming motors" if type in _MOTORS else "Throttle armed"


def disarmed_text(type: VehicleType) -> str:  # noqa: A002 (as above)
    """When the motors were disarmed."""
    return "Disarming motors" if type in _MOTORS else "Throttle disarmed"


class BootTexts:
    """Says what becomes of the sensors after the start; one of the autopilot's watches."""

    def __init__(self, autopilot: Autopilot) -> None:
        self._autopilot = autopilot
        self._script = self._settle()

    def tick(self, now: float) -> None:
        """A step further."""
        next(self._script, None)

    def _settle(self) -> Iterator[None]:
        autopilot = self._autopilot
        self._send_statustext("Calibrating barometer")
        self._send_statustext("Barometer 1 calibration complete")
        if autopilot.vehicle.type in (VehicleType.PLANE, VehicleType.VTOL):
            self._send_statustext("Airspeed 1 calibrated")
        self._send_statustext("ArduPilot Ready")
        while not autopilot.booted:
            yield
        for words in ("initialised", "tilt alignment complete", "MAG0 initial yaw alignment complete"):
            self._of_each(words)
        yield
        while not autopilot.has_position:
            yield
        self._send_statustext("GPS 1: detected u-blox")
        self._of_each("origin set")
        while autopilot.home is None:
            yield
        self._send_statustext(f"Field Elevation Set: {autopilot.home.altitude:.0f}m")
        uses_gps = False
        while True:
            if autopilot.has_position and not uses_gps:
                uses_gps = True
                self._of_each("is using GPS")
            elif uses_gps and not autopilot.has_position:
                uses_gps = False
                self._of_each("stopped aiding")
            yield

    def _of_each(self, words: str) -> None:
        for number in range(_IMUS):
            self._send_statustext(f"EKF3 IMU{number} {words}")

    def _send_statustext(self, text: str) -> None:
        self._autopilot.vehicle.send_statustext(text, _INFO)
