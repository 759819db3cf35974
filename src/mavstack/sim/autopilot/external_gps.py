"""GPS by MAVLink: a receiver outside the vehicle, whose reports come as GPS_INPUT or HIL_GPS.

The estimate follows the reports as it follows the vehicle's own receiver, GPS_RAW_INT shows them, and the
position is lost when a report has no 3D fix. Each firmware decides which messages it takes, from whom, and
after which silence the reports are no longer used (`ardupilot/external_gps.py`, `px4/external_gps.py`).
"""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.addressing import message_ids
from mavstack.services.service import Service
from mavstack.sim.motion import GpsReport
from mavstack.sim.motion.readings import DILUTION

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.dialects import Message
    from mavstack.sim.vehicle import SimulatedVehicle
    from mavstack.wire import Packet

_IGNORE = common.GpsInputIgnoreFlags
_UNKNOWN_16, _UNKNOWN_8 = 65_535, 255
#: An error above this, in metres, is sent as unknown.
_MAX_ERROR = 655.35


class ExternalGps(Service):
    """Receives the reports, and ends them after a silence.

    Args:
        vehicle: The vehicle.
        kinds: The message classes that the firmware takes.
        timeout: Silence in seconds after which the reports end.
        fallback: The report after the silence; None for the vehicle's own receiver.
        accepts: Returns whether the firmware takes reports of a packet's sender now.
    """

    def __init__(
        self,
        vehicle: SimulatedVehicle,
        kinds: tuple[type[Message], ...],
        *,
        timeout: float,
        fallback: GpsReport | None,
        accepts: Callable[[Packet], bool] = lambda packet: True,
    ) -> None:
        super().__init__(vehicle.address)
        self.handles = message_ids(*kinds)
        self._body = vehicle.body
        self._timeout, self._fallback, self._accepts = timeout, fallback, accepts
        self._report = GpsReport()
        self._due: float | None = None
        self._body.replace_gps(fallback)

    def receive(self, packet: Packet, now: float) -> bool:
        if not self._accepts(packet):
            return False
        match packet.message:
            case common.GpsInput() as message:
                self._report = _gps_input(message, self._report)
            case common.HilGps() as message:
                self._report = _hil_gps(message, self._report)
        self._body.replace_gps(self._report)
        self._due = now + self._timeout
        return True

    def next_timeout(self) -> float | None:
        return self._due

    def handle_timeout(self, now: float) -> None:
        if self._due is not None and now >= self._due:
            self._due, self._report = None, GpsReport()
            self._body.replace_gps(self._fallback)


def _gps_input(message: common.GpsInput, last: GpsReport) -> GpsReport:
    """Return the report of a GPS_INPUT; ignored fields keep their last values, an ignored altitude is 0."""
    ignored = int(message.ignore_flags)

    def used(flag: int, value: float, otherwise: float) -> float:
        return otherwise if ignored & flag or not isfinite(value) else float(value)

    down = 0.0 if ignored & _IGNORE.VEL_HORIZ else used(_IGNORE.VEL_VERT, message.vd, 0.0)
    return GpsReport(
        gps_latitude=message.lat / 1e7,
        gps_longitude=message.lon / 1e7,
        gps_altitude=used(_IGNORE.ALT, message.alt, 0.0),
        gps_velocity_north=used(_IGNORE.VEL_HORIZ, message.vn, last.gps_velocity_north),
        gps_velocity_east=used(_IGNORE.VEL_HORIZ, message.ve, last.gps_velocity_east),
        gps_velocity_down=down,
        gps_fix=int(message.fix_type),
        gps_satellites=message.satellites_visible,
        gps_eph=_error(used(_IGNORE.HDOP, message.hdop, last.gps_eph * DILUTION)),
        gps_epv=_error(used(_IGNORE.VDOP, message.vdop, last.gps_epv * DILUTION)),
    )


def _hil_gps(message: common.HilGps, last: GpsReport) -> GpsReport:
    """Return the report of a HIL_GPS."""
    satellites = message.satellites_visible
    return GpsReport(
        gps_latitude=message.lat / 1e7,
        gps_longitude=message.lon / 1e7,
        gps_altitude=message.alt / 1e3,
        gps_velocity_north=message.vn / 100.0,
        gps_velocity_east=message.ve / 100.0,
        gps_velocity_down=message.vd / 100.0,
        gps_fix=int(message.fix_type),
        gps_satellites=last.gps_satellites if satellites == _UNKNOWN_8 else satellites,
        gps_eph=last.gps_eph if message.eph == _UNKNOWN_16 else _error(message.eph / 100.0),
        gps_epv=last.gps_epv if message.epv == _UNKNOWN_16 else _error(message.epv / 100.0),
    )


def _error(dilution: float) -> float:
    """Return the expected error in metres of a dilution of precision."""
    return min(max(dilution / DILUTION, 0.0), _MAX_ERROR)
