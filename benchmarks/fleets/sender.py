"""The vehicles of a fleet: a process that sends their messages to several ports.

    python -m benchmarks.fleets.sender SECONDS VEHICLES RATE PORT [PORT …]

Each vehicle sends several messages together, `TICKS` times a second, and the vehicles send in turns. All
packets are encoded before the first one is sent. It prints the number of packets of each port.
"""

from __future__ import annotations

import socket
import sys
import time
from itertools import islice
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.wire import Encoder

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.dialects import Message

#: Ticks per second: each vehicle sends several messages together.
TICKS = 25
#: Parts of a tick.
SLOTS = 20
AUTOPILOT = common.Heartbeat(type=common.MavType.QUADROTOR, autopilot=common.MavAutopilot.PX4)


def messages(system: int) -> Iterator[Message]:
    """Yield the messages of a vehicle; the boot time is that of the caller."""
    number = 0
    while True:
        number += 1
        for kind in (common.Attitude, common.AttitudeQuaternion, common.LocalPositionNed):
            yield kind(time_boot_ms=number)
        yield common.GlobalPositionInt(lat=470_000_000 + system * 1000, lon=80_000_000, alt=number)
        yield common.VfrHud(alt=number)
        yield common.ServoOutputRaw(servo1_raw=1500)
        yield common.GpsRawInt(lat=470_000_000, lon=80_000_000, satellites_visible=12)


def packets(system: int, seconds: float, rate: int) -> list[bytes]:
    """Return the datagrams of a vehicle, one packet each; those of a tick follow each other."""
    encoder, source = Encoder(system, 1), messages(system)
    sent: list[bytes] = []
    for tick in range(int(seconds * TICKS)):
        count = rate * (tick + 1) // TICKS - rate * tick // TICKS
        is_second = tick % TICKS == 0
        boot_ms = 10_000 + 1000 * tick // TICKS
        parts = [_at(each, boot_ms) for each in islice(source, count - is_second)]
        sent.extend(map(encoder.encode, [*parts, AUTOPILOT] if is_second else parts))
    return sent


def _at(message: Message, boot_ms: int) -> Message:
    return message.replace(time_boot_ms=boot_ms) if hasattr(message, "time_boot_ms") else message


def main() -> None:
    """Send, and print the numbers."""
    seconds, vehicles, rate = float(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
    ports = [int(port) for port in sys.argv[4:]]
    fleet = [packets(system, seconds, rate) for system in range(1, vehicles + 1)]
    sockets = []
    for port in ports:
        sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        sock.connect(("127.0.0.1", port))
        sockets.append(sock)
    print("ready", flush=True)
    sys.stdin.readline()
    _send(fleet, sockets, seconds, rate)
    print(sum(map(len, fleet)), flush=True)


def _send(fleet: list[list[bytes]], sockets: list[socket.socket], seconds: float, rate: int) -> None:
    began = time.perf_counter()
    for tick in range(int(seconds * TICKS)):
        first, last = rate * tick // TICKS, rate * (tick + 1) // TICKS
        for slot in range(SLOTS):
            ahead = began + (tick + slot / SLOTS) / TICKS - time.perf_counter()
            if ahead > 0:
                time.sleep(ahead)
            for vehicle in fleet[slot::SLOTS]:
                for data in vehicle[first:last]:
                    for sock in sockets:
                        sock.send(data)


if __name__ == "__main__":
    main()
