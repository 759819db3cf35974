"""GPS by MAVLink on PX4: HIL_GPS while MAV_USEHILGPS is set.

Only reports with the vehicle's own system id count, as from a companion computer; PX4 does not handle
GPS_INPUT. After 2 s without a report the vehicle's own receiver counts again. Source: PX4, modules/mavlink
(MavlinkReceiver) and modules/sensors (GpsBlending).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.sim.autopilot.external_gps import ExternalGps

if TYPE_CHECKING:
    from mavstack.sim.vehicle import SimulatedVehicle
    from mavstack.wire import Packet

#: Seconds without a message after which the vehicle uses its own receiver again.
GPS_TIMEOUT: Final = 2.0


def register_external_gps(vehicle: SimulatedVehicle) -> None:
    """Take HIL_GPS while MAV_USEHILGPS is set."""

    def accepts(packet: Packet) -> bool:
        return packet.system == vehicle.address.system and bool(vehicle.parameters.get("MAV_USEHILGPS", 0))

    vehicle.engine.add(
        ExternalGps(vehicle, (common.HilGps,), timeout=GPS_TIMEOUT, fallback=None, accepts=accepts)
    )
