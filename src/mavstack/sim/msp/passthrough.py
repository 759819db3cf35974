"""Passthrough: a port that is connected to a serial device of the flight controller, until its peer leaves.

The simulated controllers have one such device, a GPS receiver at UART 2 that sends NMEA sentences. ESCs
cannot be flashed here: a passthrough to them finds none.
"""

from __future__ import annotations

from functools import reduce
from math import atan2, degrees, hypot
from operator import xor
from time import gmtime, strftime
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from mavstack.sim.msp.port import MspPort
    from mavstack.sim.msp.system import System

#: Modes of MSP_SET_PASSTHROUGH: select a serial port by identifier, or by function; other values select ESCs.
SERIAL_ID, SERIAL_FUNCTION = 0xFD, 0xFE
#: The serial port identifier of UART 2, and the serial port function GPS.
GPS_PORT, GPS_FUNCTION = 1, 2
_INTERVAL: Final = 0.2
_KNOTS: Final = 1.943844


class GpsReceiver:
    """The GPS receiver behind a passthrough: position and speed as NMEA, five times a second."""

    def __init__(self, system: System) -> None:
        self._system = system
        self._due = system.now

    def data_to_send(self, now: float) -> bytes:
        """Return the sentences that are due."""
        if now < self._due:
            return b""
        self._due = now + _INTERVAL
        return "".join(_sentence(text) for text in self._texts(now)).encode()

    def _texts(self, now: float) -> tuple[str, str]:
        sensors, fixed = self._system.body.sensors, self._system.has_fix
        clock, date = (
            strftime("%H%M%S", gmtime(now)) + f".{int(now % 1 * 100):02}",
            strftime("%d%m%y", gmtime(now)),
        )
        place = f"{_angle(sensors.gps_latitude, 2, 'NS')},{_angle(sensors.gps_longitude, 3, 'EW')}"
        north, east = sensors.gps_velocity_north, sensors.gps_velocity_east
        course = degrees(atan2(east, north)) % 360
        quality = f"{int(fixed)},{sensors.gps_satellites:02},{min(sensors.gps_eph, 99.9):.1f}"
        speed = hypot(north, east) * _KNOTS
        return (
            f"GPGGA,{clock},{place},{quality},{sensors.gps_altitude:.1f},M,0.0,M,,",
            f"GPRMC,{clock},{'A' if fixed else 'V'},{place},{speed:.2f},{course:.2f},{date},,",
        )


def start_passthrough(system: System, payload: bytes, port: MspPort) -> bytes:
    """Answer MSP_SET_PASSTHROUGH: 1 and a connection to the GPS receiver, or 0."""
    mode, argument = (*payload[:2], 0, 0)[:2]
    wanted = {SERIAL_ID: GPS_PORT, SERIAL_FUNCTION: GPS_FUNCTION}.get(mode)
    if len(payload) < 2 or argument != wanted:
        return b"\0"
    port.passthrough = GpsReceiver(system)
    system.host.announce("text", "passthrough to the GPS receiver")
    return b"\1"


def _angle(value: float, digits: int, letters: str) -> str:
    """Return an angle as degrees and minutes, with the letter of its hemisphere."""
    whole, minutes = divmod(abs(value) * 60, 60)
    return f"{int(whole):0{digits}}{minutes:09.6f},{letters[value < 0]}"


def _sentence(text: str) -> str:
    return f"${text}*{reduce(xor, text.encode(), 0):02X}\r\n"
