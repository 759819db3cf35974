"""A rangefinder that looks down and is read by a companion computer (DISTANCE_SENSOR).

Its distance replaces that of the vehicle's own rangefinder: in landings, in telemetry, and for a landing
target without a height. Each firmware decides which reports it takes, and for how long they count.
"""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.services.addressing import message_ids
from mavstack.services.service import Service

if TYPE_CHECKING:
    from mavstack.sim.vehicle import SimulatedVehicle
    from mavstack.wire import Packet

_CENTIMETRES: Final = 100.0
_DOWN: Final = common.MavSensorOrientation.PITCH_270


class ExternalRange(Service):
    """Keeps the last distance, and ends it after a silence.

    Args:
        vehicle: The vehicle.
        timeout: Silence in seconds after which the last report no longer counts.
        fallback: The distance in metres without reports: infinity if the vehicle has no rangefinder, None
            for the vehicle's own.
    """

    handles = message_ids(common.DistanceSensor)

    def __init__(self, vehicle: SimulatedVehicle, *, timeout: float, fallback: float | None) -> None:
        super().__init__(vehicle.address)
        self._body = vehicle.body
        self._timeout, self._fallback = timeout, fallback
        self._due: float | None = None
        self._body.range_report = fallback

    def receive(self, packet: Packet, now: float) -> bool:
        match packet.message:
            case common.DistanceSensor(orientation=direction) as report if direction == _DOWN:
                in_range = report.min_distance <= report.current_distance <= report.max_distance
                self._body.range_report = report.current_distance / _CENTIMETRES if in_range else inf
                self._due = now + self._timeout
                return True
        return False

    def next_timeout(self) -> float | None:
        return self._due

    def handle_timeout(self, now: float) -> None:
        if self._due is not None and now >= self._due:
            self._due, self._body.range_report = None, self._fallback
