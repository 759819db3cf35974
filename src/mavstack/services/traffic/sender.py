"""Shows vehicles the aircraft around them (ADSB_VEHICLE).

Autopilots keep a short list (ArduPilot 25 aircraft by default), and radios are slow. So once a second the
nearest aircraft of each vehicle are sent to all, each once, while the links have room for streams.
"""

from __future__ import annotations

from collections import deque
from math import isfinite
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.services.addressing import BROADCAST, Address
from mavstack.services.service import HasRoom, Outgoing, Priority, Service, always_room

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from mavstack.traffic import Aircraft

INTERVAL: Final = 1.0
_FLAGS = common.AdsbFlags
_UNKNOWN_SPEED: Final = 65_535
_CENTI: Final = 100.0


class TrafficSender(Service):
    """Sends aircraft to all vehicles, or to one.

    Args:
        local: The address of the ground station.
    """

    def __init__(self, local: Address) -> None:
        super().__init__(local)
        self._waiting: deque[tuple[common.AdsbVehicle, Address]] = deque()
        #: The number of messages sent, and of messages replaced by newer ones because a link was too slow.
        self.sent = self.late = 0

    def show(self, aircraft: Iterable[Aircraft], now: float, target: Address = BROADCAST) -> None:
        """Send aircraft, instead of those of the last call that still wait for the same target."""
        kept = [item for item in self._waiting if item[1] != target]
        self.late += len(self._waiting) - len(kept)
        self._waiting = deque(kept)
        self._waiting += [(to_message(each, now), target) for each in aircraft]

    def bulk_messages(self, now: float, has_room: HasRoom = always_room) -> Iterator[Outgoing]:
        while self._waiting and has_room(self._waiting[0][1], Priority.STREAM):
            message, target = self._waiting.popleft()
            self.sent += 1
            yield Outgoing(message, target, Priority.STREAM)


def to_message(aircraft: Aircraft, now: float) -> common.AdsbVehicle:
    """Return the message of an aircraft; values that are not known are 0 without their flag."""
    flags = 0
    latitude = longitude = 0
    if aircraft.latitude is not None and aircraft.longitude is not None:
        flags |= _FLAGS.VALID_COORDS
        latitude, longitude = round(aircraft.latitude * 1e7), round(aircraft.longitude * 1e7)
    if aircraft.altitude is not None:
        flags |= _FLAGS.VALID_ALTITUDE | (0 if aircraft.is_geometric else _FLAGS.BARO_VALID)
    flags |= _FLAGS.VALID_HEADING if aircraft.course is not None else 0
    flags |= _FLAGS.VALID_VELOCITY if aircraft.speed is not None else 0
    flags |= _FLAGS.VERTICAL_VELOCITY_VALID if aircraft.climb is not None else 0
    flags |= _FLAGS.VALID_CALLSIGN if aircraft.callsign else 0
    flags |= _FLAGS.VALID_SQUAWK if aircraft.squawk is not None else 0
    kind = common.AdsbAltitudeType
    return common.AdsbVehicle(
        ICAO_address=aircraft.address,
        lat=latitude,
        lon=longitude,
        altitude_type=kind.GEOMETRIC if aircraft.is_geometric else kind.PRESSURE_QNH,
        altitude=_bounded(aircraft.altitude, 1e3, -(2**31), 2**31 - 1),
        heading=_bounded(aircraft.course, _CENTI, 0, 35_999),
        hor_velocity=_bounded(aircraft.speed, _CENTI, 0, _UNKNOWN_SPEED - 1),
        ver_velocity=_bounded(aircraft.climb, _CENTI, -32_768, 32_767),
        callsign=(aircraft.callsign or "")[:8],
        emitter_type=common.AdsbEmitterType.NO_INFO,
        tslc=_bounded(now - aircraft.seen, 1.0, 0, 255),
        flags=flags,
        squawk=aircraft.squawk or 0,
    )


def _bounded(value: float | None, factor: float, low: int, high: int) -> int:
    if value is None or not isfinite(value):
        return 0
    return round(min(max(value * factor, low), high))
