"""The state of the vehicles of a fleet, collected from their messages for the live display."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field, replace
from math import cos, hypot, radians
from typing import TYPE_CHECKING

from mavstack.cli.common.identity import Identity, identify
from mavstack.dialects import common
from mavstack.geodesy import METRES_PER_DEGREE

if TYPE_CHECKING:
    from mavstack.dialects import Dialect
    from mavstack.wire import Packet

#: Maximum number of positions in a track, and minimum distance of two positions in metres.
MAX_TRACK = 400
_MIN_TRACK_STEP = 2.0
_MAX_TEXTS = 100
#: Firmware by the first bytes of `flight_custom_version`, which the MSP bridge sets.
_FIRMWARES = {b"BTFL": "Betaflight", b"INAV": "iNav"}
_UNKNOWN_PERCENT = -1


@dataclass(slots=True)
class FleetVehicle:
    """The latest state of one vehicle: degrees, metres above home, m/s, battery in percent."""

    system: int
    identity: Identity
    last_heartbeat: float = 0.0
    latitude: float | None = None
    longitude: float | None = None
    height: float = 0.0
    speed: float = 0.0
    climb: float = 0.0
    heading: float = 0.0
    battery: int | None = None
    item: int | None = None
    items: int | None = None
    #: Mode names by mode number, and name of the firmware, if the HEARTBEAT of the vehicle does not define
    #: them.
    mode_names: dict[int, str] = field(default_factory=dict)
    firmware: str = ""
    track: deque[tuple[float, float]] = field(default_factory=lambda: deque(maxlen=MAX_TRACK))

    def distance_to_track_end(self, latitude: float, longitude: float) -> float:
        """Return the distance of a place to the last place of the track, in metres."""
        if not self.track:
            return float("inf")
        north, east = self.track[-1]
        return hypot(latitude - north, (longitude - east) * cos(radians(latitude))) * METRES_PER_DEGREE


@dataclass(frozen=True, slots=True)
class FleetSnapshot:
    """A fleet at one moment: vehicles by system id, and status texts with time and system id."""

    now: float
    vehicles: tuple[FleetVehicle, ...]
    texts: tuple[tuple[float, int, str], ...]

    def vehicle(self, system: int) -> FleetVehicle | None:
        """Return the vehicle with a system id; None if there is none."""
        return next((each for each in self.vehicles if each.system == system), None)


class FleetState:
    """The vehicles of a fleet by system id, and their last status texts."""

    def __init__(self, dialect: Dialect) -> None:
        self._dialect = dialect
        self.vehicles: dict[int, FleetVehicle] = {}
        self.texts: deque[tuple[float, int, str]] = deque(maxlen=_MAX_TEXTS)
        #: The parts of the flight that were announced, in order.
        self.parts: list[str] = []

    def announce(self, part: str) -> None:
        """Note that a part of the flight begins."""
        self.parts.append(part)

    def update(self, packet: Packet, now: float) -> None:
        """Update the state from a packet."""
        message = packet.message
        if isinstance(message, common.Heartbeat):
            self._heartbeat(packet, message, now)
            return
        vehicle = self.vehicles.get(packet.system)
        if vehicle is None:
            return
        match message:
            case common.GlobalPositionInt(lat=latitude, lon=longitude) if latitude or longitude:
                _update_position(vehicle, message)
            case common.VfrHud(groundspeed=speed, climb=climb, heading=heading):
                vehicle.speed, vehicle.climb, vehicle.heading = speed, climb, heading
            case common.SysStatus(battery_remaining=percent):
                vehicle.battery = percent if percent > _UNKNOWN_PERCENT else None
            case common.MissionCurrent(seq=item, total=total):
                vehicle.item, vehicle.items = item, total if 0 < total < 0xFFFF else None
            case common.AvailableModes(custom_mode=number, mode_name=name):
                vehicle.mode_names[number] = name
            case common.AutopilotVersion(flight_custom_version=version):
                vehicle.firmware = _FIRMWARES.get(bytes(version)[:4], "")
            case common.Statustext(text=text):
                self.texts.append((now, packet.system, text.rstrip()))

    def snapshot(self, now: float) -> FleetSnapshot:
        """Return a copy of the state, which another thread can read."""
        vehicles = (self.vehicles[system] for system in sorted(self.vehicles))
        copies = tuple(replace(vehicle, track=vehicle.track.copy()) for vehicle in vehicles)
        return FleetSnapshot(now, copies, tuple(self.texts))

    def _heartbeat(self, packet: Packet, message: common.Heartbeat, now: float) -> None:
        if message.autopilot == common.MavAutopilot.INVALID:
            return
        identity = identify(packet.component, packet, self._dialect)
        vehicle = self.vehicles.get(packet.system)
        if vehicle is None:
            vehicle = self.vehicles[packet.system] = FleetVehicle(packet.system, identity)
        identity = identity._replace(
            mode=vehicle.mode_names.get(message.custom_mode, identity.mode),
            autopilot=vehicle.firmware or identity.autopilot,
        )
        vehicle.identity, vehicle.last_heartbeat = identity, now


def _update_position(vehicle: FleetVehicle, message: common.GlobalPositionInt) -> None:
    vehicle.latitude, vehicle.longitude = message.lat / 1e7, message.lon / 1e7
    vehicle.height = message.relative_alt / 1000
    if vehicle.distance_to_track_end(vehicle.latitude, vehicle.longitude) >= _MIN_TRACK_STEP:
        vehicle.track.append((vehicle.latitude, vehicle.longitude))
