"""The serial port of the first GPS receiver (SERIAL_CONTROL), which sends its position as NMEA each second.

As on a real ArduPilot, bytes of the port are sent only as the answer to a request; those that no client asks
for are dropped, oldest first. What is written to the port changes nothing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.gnss import Fix, format_gga, format_rmc
from mavstack.services.serial_control import ShellServer
from mavstack.services.service import HasRoom, Service, always_room

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.services.service import Outgoing
    from mavstack.sim.vehicle import SimulatedVehicle
    from mavstack.wire import Packet

REPORT_INTERVAL: Final = 1.0
#: Maximum bytes of the receiver's output that wait for a client; the oldest are dropped.
MAX_WAITING: Final = 1024


class GpsPort(Service):
    """The port of the receiver; it reports while a client has it open."""

    handles = ShellServer.handles

    def __init__(self, vehicle: SimulatedVehicle) -> None:
        super().__init__(vehicle.address)
        self._vehicle = vehicle
        self._server = ShellServer(vehicle.address, common.SerialControlDev.DEV_GPS1)
        self._waiting = bytearray()
        self._due: float | None = None

    def receive(self, packet: Packet, now: float) -> None:
        self._server.receive(packet, now)
        self._server.events()
        if self._server.owner is None:
            self._due = None
            self._waiting.clear()
            return
        self._due = now if self._due is None else self._due
        if self._waiting:
            self._server.feed(bytes(self._waiting))
            self._waiting.clear()

    def bulk_messages(self, now: float, has_room: HasRoom = always_room) -> Iterator[Outgoing]:
        return self._server.bulk_messages(now, has_room)

    def next_timeout(self) -> float | None:
        return self._due

    def handle_timeout(self, now: float) -> None:
        if self._due is not None and now >= self._due:
            self._due = now + REPORT_INTERVAL
            self._waiting += self._report(now)
            del self._waiting[: max(len(self._waiting) - MAX_WAITING, 0)]

    def _report(self, now: float) -> bytes:
        readings = self._vehicle.body.sensors
        place = readings.gps_latitude, readings.gps_longitude, readings.gps_altitude
        fix = Fix(now, *place, fix_type=readings.gps_fix, satellites=readings.gps_satellites)
        return format_gga(fix) + format_rmc(fix)
