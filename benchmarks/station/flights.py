"""A fleet in flight on UDP, for the benchmark: `python -m benchmarks.station.flights PORT VEHICLES`.

Each vehicle flies a circle of its own and sends attitude and position ten times a second, the rest more
slowly. The vehicles send one after the other, so that packets arrive at all times, as they do from real ones.
The program ends when its standard input is closed.
"""

from __future__ import annotations

import select
import socket
import sys
from math import cos, pi, radians, sin
from time import monotonic
from typing import TYPE_CHECKING, Final

from mavstack.dialects import ardupilotmega as dialect
from mavstack.geodesy import METRES_PER_DEGREE
from mavstack.wire import Encoder

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.dialects import Message

HOST = "127.0.0.1"
RATE: Final = 10
#: Steps of a second, in each of which a share of the vehicles sends.
STEPS: Final = 200
LATITUDE, LONGITUDE, ALTITUDE = 47.3494, 8.5363, 407.0
#: Metres between vehicles, radius of their circles, seconds of a turn.
SPACING, RADIUS, TURN = 260.0, 70.0, 40.0


def fast(number: int, now: float) -> Iterator[Message]:
    """Yield the messages of each turn of a vehicle."""
    angle = 2 * pi * now / TURN + number
    row, column = divmod(number, 10)
    north = (row - 4.5) * SPACING + RADIUS * cos(angle)
    east = (column - 4.5) * SPACING + RADIUS * sin(angle)
    height, speed = 60 + number + 5 * sin(angle), 2 * pi * RADIUS / TURN
    yaw = (angle + pi / 2) % (2 * pi)
    boot = int(now * 1000)
    yield dialect.Attitude(time_boot_ms=boot, roll=0.3 + 0.05 * sin(now), pitch=0.05 * cos(now), yaw=yaw)
    yield dialect.GlobalPositionInt(
        time_boot_ms=boot,
        lat=round((LATITUDE + north / METRES_PER_DEGREE) * 1e7),
        lon=round((LONGITUDE + east / METRES_PER_DEGREE / cos(radians(LATITUDE))) * 1e7),
        alt=round((ALTITUDE + height) * 1000),
        relative_alt=round(height * 1000),
        vx=round(-100 * speed * sin(angle)),
        vy=round(100 * speed * cos(angle)),
        hdg=round(yaw * 18_000 / pi),
    )
    yield dialect.VfrHud(airspeed=speed, groundspeed=speed, heading=int(yaw * 180 / pi), throttle=50)


def slow(now: float) -> Iterator[Message]:
    """Yield the messages of each second of a vehicle."""
    yield dialect.Heartbeat(
        type=2, autopilot=3, base_mode=0xD9, custom_mode=3, system_status=4, mavlink_version=3
    )
    yield dialect.SysStatus(
        voltage_battery=15_800, current_battery=1200, battery_remaining=int(100 - now / 60) % 100
    )
    yield dialect.GpsRawInt(fix_type=4, satellites_visible=15, eph=70, epv=110)
    yield dialect.ExtendedSysState(landed_state=2)
    yield dialect.RcChannels(chancount=8, chan1_raw=1500, chan2_raw=1500, chan3_raw=1100, rssi=200)
    yield dialect.HomePosition(
        latitude=round(LATITUDE * 1e7), longitude=round(LONGITUDE * 1e7), altitude=407_000
    )


def main() -> None:
    """Send until standard input is closed."""
    port, count = map(int, sys.argv[1:3])
    encoders = [Encoder(number + 1, 1) for number in range(count)]
    done, started = 0, monotonic()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        while not select.select([sys.stdin], [], [], 1 / STEPS)[0]:
            now = monotonic() - started
            due = int(now * RATE * count)
            for turn in range(done, due):
                number, encoder = turn % count, encoders[turn % count]
                messages = [*fast(number, now), *(slow(now) if turn // count % RATE == number % RATE else ())]
                sock.sendto(b"".join(map(encoder.encode, messages)), (HOST, port))
            done = due


if __name__ == "__main__":
    main()
