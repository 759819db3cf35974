"""Precision landing of ArduPilot's copters: PLND_ENABLED 1, and PLND_TYPE 1 (MAVLink) at boot.

LANDING_TARGET counts in the axes of the body (BODY_FRD, `position_valid` and a distance), or as two angles
with a distance or with the height of a rangefinder, if the target is below the vehicle. After 2 s of reports
that are less than 0.5 s apart the target is used (PLND_EST_TYPE 0: at once), until 2 s without a report. A
landing vehicle flies above the target, and descends while it is nearer than PLND_XY_DIST_MAX. If the target
is lost, a vehicle without a rangefinder lands on its last position; one with a rangefinder tries again
(`landing_retries.py`).

Source: ArduPilot 4.6, AC_PrecLand.cpp, AC_PrecLand_MAVLink.cpp, ArduCopter/mode.cpp.
"""

from __future__ import annotations

from math import hypot, isfinite, sqrt, tan
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.sim.ardupilot.landing_retries import LandingRetries
from mavstack.sim.autopilot.landing_target import LandingAim, LandingTarget, from_body
from mavstack.sim.parameters.tables import group_definitions
from mavstack.sim.vehicle_types import Firmware, VehicleType

if TYPE_CHECKING:
    from mavstack.sim.autopilot.maneuvers import Point
    from mavstack.sim.vehicle import SimulatedVehicle

_ENABLED: Final = "PLND_ENABLED"
_TYPE: Final = "PLND_TYPE"
_MAVLINK: Final = 1
_RAW: Final = 0
#: In seconds: reports are needed for the first time until the target is used; a gap longer than the second
#: restarts this initialisation; a gap longer than the third loses a target in use.
_INIT_TIME: Final = 2.0
_INIT_GAP: Final = 0.5
_TIMEOUT: Final = 2.0
_SEVERITY = common.MavSeverity


def register_precision_landing(vehicle: SimulatedVehicle) -> None:
    """Use LANDING_TARGET as the parameters say, and show them once PLND_ENABLED is set."""
    if vehicle.vehicle_type is not VehicleType.COPTER:
        return
    _show_parameters(vehicle)
    vehicle.parameters.on_change(_ENABLED, lambda _: _show_parameters(vehicle))
    if int(vehicle.parameters.get(_TYPE, 0)) == _MAVLINK:
        PrecisionLanding(vehicle)


def _show_parameters(vehicle: SimulatedVehicle) -> None:
    if vehicle.parameters.get(_ENABLED, 0) and _TYPE not in vehicle.parameters:
        for definition in group_definitions(Firmware.ARDUPILOT, "precision_landing"):
            vehicle.parameters.table.add(definition)


class PrecisionLanding:
    """The estimator of the target; one of the autopilot's periodic checks.

    Args:
        vehicle: The copter.
    """

    def __init__(self, vehicle: SimulatedVehicle) -> None:
        self._vehicle = vehicle
        self._target = vehicle.engine.add(LandingTarget(vehicle, self._read))
        #: The time at which the target was found; None while there are no reports of a target.
        self._found_at: float | None = None
        self._acquired = False
        self._refused_frame = False
        self._retries = LandingRetries(vehicle)
        vehicle.autopilot.watches.append(self)
        vehicle.autopilot.landing_aim = self.aim

    def tick(self, now: float) -> None:
        """Find the target, use it, and lose it, each with its status text."""
        gap = now - self._target.received_at
        if self._found_at is None:
            if gap <= _INIT_GAP:
                self._found_at = now
                self._report("Target Found", _SEVERITY.INFO)
                self._acquired = int(self._number("PLND_EST_TYPE")) == _RAW
        elif self._acquired:
            if gap > _TIMEOUT:
                self._lose("Target Lost")
        elif gap > _INIT_GAP:
            self._lose("Init Failed")
        elif now - self._found_at > _INIT_TIME:
            self._acquired = True
            self._report("Init Complete", _SEVERITY.INFO)
        self._retries.note(self._target.place if self._acquired else None, now)

    def aim(self) -> LandingAim | None:
        """Return the place to land on, or to fly to for another try; None: the landing just continues."""
        if not self._number(_ENABLED):
            return None
        if (other := self._retries.aim(self._vehicle.now)) is not None:
            return other
        place = self._target.place
        if not self._acquired or place is None:
            return None
        here, limit = self._vehicle.autopilot.maneuvers.place, self._number("PLND_XY_DIST_MAX")
        away = hypot(place[0] - here[0], place[1] - here[1])
        return LandingAim(place, descends=limit == 0 or away <= limit)

    def _lose(self, text: str) -> None:
        self._found_at, self._acquired = None, False
        self._report(text, _SEVERITY.CRITICAL)

    def _report(self, text: str, severity: int) -> None:
        self._vehicle.send_statustext(f"PrecLand: {text}", severity)

    def _read(self, message: common.LandingTarget) -> Point | None:
        if not self._number(_ENABLED):
            return None
        seen = self._seen(message)
        if seen is None or not all(map(isfinite, seen)) or seen[2] <= 0:
            return None
        return from_body(self._vehicle, seen)

    def _seen(self, message: common.LandingTarget) -> Point | None:
        """Return the place in the axes of the body."""
        if message.position_valid == 1:
            if message.frame == common.MavFrame.BODY_FRD:
                return (message.x, message.y, message.z) if message.distance > 0 else None
            if not self._refused_frame:
                self._refused_frame = True
                self._vehicle.send_statustext("Plnd: Frame not supported ", _SEVERITY.INFO)
            return None
        if not (isfinite(message.angle_x) and isfinite(message.angle_y)):
            return None
        forward, right = -tan(message.angle_y), tan(message.angle_x)
        height = self._vehicle.body.sensors.distance
        if message.distance > 0:
            height = message.distance / sqrt(forward * forward + right * right + 1)
        return forward * height, right * height, height

    def _number(self, name: str) -> float:
        return float(self._vehicle.parameters.get(name, 0.0))
