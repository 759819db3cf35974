"""GPS by MAVLink on ArduPilot: GPS1_TYPE 14 (MAV) at boot replaces the vehicle's receiver, and 0 removes it.

GPS_INPUT and HIL_GPS of any sender count. There is no fix until the first of them, and
after 4 s without one. Source: ArduPilot, libraries/AP_GPS (AP_GPS_MAV, GPS_TIMEOUT_MS).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.sim.autopilot.external_gps import ExternalGps
from mavstack.sim.motion import GpsReport

if TYPE_CHECKING:
    from mavstack.sim.vehicle import SimulatedVehicle

#: The value of GPS1_TYPE for a receiver that speaks MAVLink.
GPS_TYPE_MAV: Final = 14
#: The value of GPS_FIX_TYPE when no receiver is connected.
_NO_GPS: Final = 0
#: Seconds without a message of the receiver after which the fix is lost.
GPS_TIMEOUT: Final = 4.0


def register_external_gps(vehicle: SimulatedVehicle) -> None:
    """Select the GPS receiver of this boot by GPS1_TYPE."""
    kind = int(vehicle.parameters.get("GPS1_TYPE", 1))
    vehicle.body.replace_gps(None if kind else GpsReport(gps_fix=_NO_GPS))
    if kind == GPS_TYPE_MAV:
        kinds = (common.GpsInput, common.HilGps)
        vehicle.engine.add(ExternalGps(vehicle, kinds, timeout=GPS_TIMEOUT, fallback=GpsReport()))
