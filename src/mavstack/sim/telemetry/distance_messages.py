"""Messages of chosen rangefinders and of a proximity sensor.

OBSTACLE_DISTANCE comes from the component of the autopilot, for both firmwares; a real ArduPilot receives it
from the sensor, and leaves it to the link to forward it to ground stations.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import ardupilotmega, common
from mavstack.sim.rangefinders import PROXIMITY_RANGE, SECTOR_WIDTH, SECTORS
from mavstack.sim.telemetry.scaling import uint16

if TYPE_CHECKING:
    from mavstack.dialects import Message
    from mavstack.services.message_request.server import Producer
    from mavstack.sim.rangefinders import Rangefinder
    from mavstack.sim.telemetry.view import VehicleView

_CENTIMETRES: Final = 100.0
_DOWNWARD: Final = common.MavSensorOrientation.PITCH_270
#: Signal quality in percent if the distance is in range, and if it is out of range.
_GOOD, _NOTHING = 100, 1
#: Value of `covariance` in DISTANCE_SENSOR if the variance is not known.
_UNKNOWN: Final = 255
#: Volts per metre of an analogue sensor; an out-of-range distance is reported as the maximum plus this many
#: metres.
_VOLTS_PER_METRE, _EXCESS = 0.1, 0.01


class DistanceMessages:
    """Producers of the messages of one vehicle's distance sensors."""

    def __init__(self, view: VehicleView) -> None:
        self._view = view
        self._body = view.body
        self._rangefinders = view.vehicle.rangefinders

    def producers(self) -> dict[type[Message], Producer]:
        """Return the producers of the sensors that the vehicle has; empty if it has none."""
        made: dict[type[Message], Producer] = {}
        if self._rangefinders:
            made[common.DistanceSensor] = self.distance_sensors
        if self._view.vehicle.proximity:
            made[common.ObstacleDistance] = self.obstacle_distance
        return made

    def ardupilot_producers(self) -> dict[type[Message], Producer]:
        """Return the same, and the producer of ArduPilot's message of a downward rangefinder."""
        made = self.producers()
        return {**made, ardupilotmega.Rangefinder: self.rangefinder} if self._rangefinders else made

    def distance_sensors(self, now: float) -> list[Message]:
        """Return DISTANCE_SENSOR of each rangefinder; nothing in range reads as just beyond the maximum."""
        return [
            self._distance_sensor(number, each, now)
            for number, each in enumerate(self._rangefinders)
            if self._is_enabled(number)
        ]

    def _is_enabled(self, number: int) -> bool:
        """Return whether the parameters enable a rangefinder; PX4 has none for it."""
        return self._view.parameter(f"RNGFND{number + 1}_TYPE", 1) > 0

    def _distance_sensor(self, number: int, rangefinder: Rangefinder, now: float) -> Message:
        distance = rangefinder.measure(self._body.truth, self._body.surroundings)
        low, high = (round(each * _CENTIMETRES) for each in rangefinder.range)
        return common.DistanceSensor(
            time_boot_ms=self._view.milliseconds(now),
            min_distance=low,
            max_distance=high,
            current_distance=high + 1 if distance is None else uint16(distance * _CENTIMETRES),
            type=rangefinder.kind,
            id=number,
            orientation=rangefinder.orientation,
            covariance=_UNKNOWN,
            signal_quality=_NOTHING if distance is None else _GOOD,
        )

    def rangefinder(self, now: float) -> Message | None:
        """Return RANGEFINDER of the first downward rangefinder; None without one."""
        for number, each in enumerate(self._rangefinders):
            if each.orientation == _DOWNWARD and self._is_enabled(number):
                distance = each.measure(self._body.truth, self._body.surroundings)
                metres = each.range[1] + _EXCESS if distance is None else distance
                return ardupilotmega.Rangefinder(distance=metres, voltage=metres * _VOLTS_PER_METRE)
        return None

    def obstacle_distance(self, now: float) -> Message:
        """Return OBSTACLE_DISTANCE: the nearest obstacle per sector, the first of which looks forward."""
        truth = self._body.truth
        here = truth.north, truth.east, truth.down
        low, high = (round(each * _CENTIMETRES) for each in PROXIMITY_RANGE)
        measured = self._body.surroundings.sectors(here, truth.yaw, SECTORS)
        return common.ObstacleDistance(
            time_usec=self._view.microseconds(now),
            sensor_type=common.MavDistanceSensor.LASER,
            distances=[min(max(round(min(each, high) * _CENTIMETRES), low), high + 1) for each in measured],
            increment=SECTOR_WIDTH,
            min_distance=low,
            max_distance=high,
            increment_f=float(SECTOR_WIDTH),
            frame=common.MavFrame.BODY_FRD,
        )
