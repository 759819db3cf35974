"""SET_GPS_GLOBAL_ORIGIN: a vehicle without GPS learns where its local frame is on Earth.

The frame of a simulated vehicle begins at its start. So the message says that the place is known, and does
not move the frame; the answer is GPS_GLOBAL_ORIGIN with the place of the start.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Self

from mavstack.dialects import common
from mavstack.services.addressing import BROADCAST, message_ids
from mavstack.services.service import Service

if TYPE_CHECKING:
    from mavstack.sim.vehicle import SimulatedVehicle
    from mavstack.wire import Packet

_MAX_LATITUDE, _MAX_LONGITUDE = 900_000_000, 1_800_000_000


class OriginReceiver(Service):
    """Receives the origin."""

    handles = message_ids(common.SetGpsGlobalOrigin)

    def __init__(self, vehicle: SimulatedVehicle) -> None:
        super().__init__(vehicle.address)
        self._vehicle = vehicle

    @classmethod
    def add_to(cls, vehicle: SimulatedVehicle) -> Self:
        """Let a vehicle receive its origin until the next boot."""
        return vehicle.engine.add(cls(vehicle))

    def receive(self, packet: Packet, now: float) -> None:
        match packet.message:
            case common.SetGpsGlobalOrigin(target_system=system) as message:
                on_earth = abs(message.latitude) <= _MAX_LATITUDE and abs(message.longitude) <= _MAX_LONGITUDE
                if system in (BROADCAST.system, self.local.system) and on_earth:
                    self._vehicle.autopilot.has_origin = True
                    self.send(self._origin(now))

    def _origin(self, now: float) -> common.GpsGlobalOrigin:
        latitude, longitude, altitude = self._vehicle.body.frame.to_global(0.0, 0.0, 0.0)
        return common.GpsGlobalOrigin(
            latitude=round(latitude * 1e7),
            longitude=round(longitude * 1e7),
            altitude=round(altitude * 1e3),
            time_usec=int((now - self._vehicle.booted_at) * 1e6),
        )
