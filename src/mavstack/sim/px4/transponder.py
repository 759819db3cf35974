"""PX4 and a uAvionix transponder at a MAVLink link of the mode uAvionix.

The link has UAVIONIX_ADSB_OUT_CFG each 10 s and UAVIONIX_ADSB_OUT_DYNAMIC each 0.2 s; the parameters ADSB_…
set their values, and no message of a ground station changes them. The callsign, the ICAO address and the
sizes count from the next boot on. While PX4 is armed it sets all bits of the state, ON_GROUND too.
Source: PX4 1.15, mavlink/streams/UAVIONIX_ADSB_OUT_CFG.hpp and UAVIONIX_ADSB_OUT_DYNAMIC.hpp.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import uavionix
from mavstack.sim.telemetry.scaling import uint8, uint16

if TYPE_CHECKING:
    from mavstack.sim.vehicle import SimulatedVehicle

CONFIGURATION_INTERVAL: Final = 10.0
DYNAMIC_INTERVAL: Final = 0.2
_FIX_3D: Final = 3
_ALL: Final = 0xFFFF
_CALLSIGN: Final = frozenset(b"ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789 \0")


class TransponderLink:
    """The link of one boot; runs on each tick, and does nothing for a vehicle without a transponder."""

    def __init__(self, vehicle: SimulatedVehicle) -> None:
        self._vehicle = vehicle
        self._configuration = self._configure()
        self._configured = self._due = float("-inf")
        vehicle.autopilot.watches.append(self)

    def tick(self, now: float) -> None:
        """Send what is due."""
        transponder = self._vehicle.transponder
        if transponder is None or now < self._due:
            return
        self._due = now + DYNAMIC_INTERVAL
        if now - self._configured >= CONFIGURATION_INTERVAL:
            self._configured = now
            transponder.take(self._configuration)
        transponder.take(self._dynamic(now))

    def _configure(self) -> uavionix.UavionixAdsbOutCfg:
        words = self._number("ADSB_CALLSIGN_1"), self._number("ADSB_CALLSIGN_2")
        callsign = b"".join((word & 0xFFFF_FFFF).to_bytes(4, "big") for word in words)
        return uavionix.UavionixAdsbOutCfg(
            ICAO=self._number("ADSB_ICAO_ID") & 0xFFFF_FFFF,
            callsign=callsign.decode() if _CALLSIGN.issuperset(callsign) else "",
            emitterType=self._number("ADSB_EMIT_TYPE"),
            aircraftSize=self._number("ADSB_LEN_WIDTH"),
            gpsOffsetLat=self._number("ADSB_GPS_OFF_LAT"),
            gpsOffsetLon=self._number("ADSB_GPS_OFF_LON"),
            stallSpeed=uint16(float(self._vehicle.parameters.get("FW_AIRSPD_STALL", 0.0)) * 100),
            rfSelect=uavionix.UavionixAdsbOutRfSelect.TX_ENABLED,
        )

    def _dynamic(self, now: float) -> uavionix.UavionixAdsbOutDynamic:
        readings, estimate = self._vehicle.body.sensors, self._vehicle.body.estimate
        armed = self._vehicle.autopilot.armed
        return uavionix.UavionixAdsbOutDynamic(
            utcTime=round(now),
            gpsLat=round(readings.gps_latitude * 1e7),
            gpsLon=round(readings.gps_longitude * 1e7),
            gpsAlt=round(readings.gps_altitude * 1e3),
            gpsFix=_FIX_3D,
            numSats=uint8(readings.gps_satellites),
            baroAltMSL=round(readings.pressure),
            accuracyHor=round(readings.gps_eph * 1e3),
            accuracyVert=uint16(readings.gps_epv * 100),
            velVert=round(-estimate.velocity_down * 100),
            velNS=round(estimate.velocity_north * 100),
            VelEW=round(estimate.velocity_east * 100),
            emergencyStatus=self._number("ADSB_EMERGC"),
            state=_ALL if armed else uavionix.UavionixAdsbOutDynamicState.ON_GROUND,
            squawk=self._number("ADSB_SQUAWK"),
        )

    def _number(self, name: str) -> int:
        return int(self._vehicle.parameters[name])
