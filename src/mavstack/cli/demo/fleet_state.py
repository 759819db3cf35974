"""What is known about each vehicle of a fleet, from what all of them say: for a picture of the whole."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field, replace
from math import cos, hypot, radians
from typing import TYPE_CHECKING

from mavstack.cli.common.identity import Identity, identify
from mavstack.dialects import common

if TYPE_CHECKING:
    from mavstack.dialects import Dialect
    from mavstack.wire import Packet

#: How many places of a vehicle's track are kept, and how far they are apart at least, in metres.
TRACK = 400
_APART = 2.0
_TEXTS = 100
_METRES_PER_DEGREE = 111_319.5
_UNKNOWN_PERCENT = -1


@dataclass(slots=True)
class Seen:
    """One vehicle as it was last heard; places are degrees, heights metres above home, speeds m/s."""

    system: int
    identity: Identity
    heard: float = 0.0
    latitude: float | None = None
    longitude: float | None = None
    height: float = 0.0
    speed: float = 0.0
    climb: float = 0.0
    heading: float = 0.0
    battery: int | None = None
    item: int | None = None
    items: int | None = None
    track: deque[tuple[float, float]] = field(default_factory=lambda: deque(maxlen=TRACK))

    def distance_to_track_end(self, latitude: float, longitude: float) -> float:
        """How far a place is from the last one kept, in metres."""
        if not self.track:
            return float("inf")
        north, east = self.track[-1]
        return hypot(latitude - north, (longitude - east) * cos(radians(latitude))) * _METRES_PER_DEGREE


@dataclass(frozen=True, slots=True)
class Moment:
    """A fleet at one moment, by system id, and what was said until then: when, by which system, what."""

    now: float
    vehicles: tuple[Seen, ...]
    texts: tuple[tuple[float, int, str], ...]

    def vehicle(self, system: int) -> Seen | None:
        """The vehicle of a system id."""
        return next((seen for seen in self.vehicles if seen.system == system), None)


class FleetWatch:
    """All vehicles heard, by system id, and what they said last."""

    def __init__(self, dialect: Dialect) -> None:
        self._dialect = dialect
        self.vehicles: dict[int, Seen] = {}
        self.texts: deque[tuple[float, int, str]] = deque(maxlen=_TEXTS)

    def take(self, packet: Packet, now: float) -> None:
        """Learn from a packet."""
        message = packet.message
        if isinstance(message, common.Heartbeat):
            self._heartbeat(packet, message, now)
            return
        seen = self.vehicles.get(packet.system)
        if seen is None:
            return
        match message:
            case common.GlobalPositionInt(lat=latitude, lon=longitude) if latitude or longitude:
                _position(seen, message)
            case common.VfrHud(groundspeed=speed, climb=climb, heading=heading):
                seen.speed, seen.climb, seen.heading = speed, climb, heading
            case common.SysStatus(battery_remaining=percent):
                seen.battery = percent if percent > _UNKNOWN_PERCENT else None
            case common.MissionCurrent(seq=item, total=total):
                seen.item, seen.items = item, total if 0 < total < 0xFFFF else None
            case common.Statustext(text=text):
                self.texts.append((now, packet.system, text))

    def moment(self, now: float) -> Moment:
        """Everything as it is now, for somebody who looks at it while more comes in."""
        vehicles = (self.vehicles[system] for system in sorted(self.vehicles))
        copies = tuple(replace(seen, track=seen.track.copy()) for seen in vehicles)
        return Moment(now, copies, tuple(self.texts))

    def _heartbeat(self, packet: Packet, message: common.Heartbeat, now: float) -> None:
        if message.autopilot == common.MavAutopilot.INVALID:
            return
        identity = identify(packet.component, packet, self._dialect)
        seen = self.vehicles.get(packet.system)
        if seen is None:
            seen = self.vehicles[packet.system] = Seen(packet.system, identity)
        seen.identity, seen.heard = identity, now


def _position(seen: Seen, message: common.GlobalPositionInt) -> None:
    seen.latitude, seen.longitude = message.lat / 1e7, message.lon / 1e7
    seen.height = message.relative_alt / 1000
    if seen.distance_to_track_end(seen.latitude, seen.longitude) >= _APART:
        seen.track.append((seen.latitude, seen.longitude))
