"""A UDP relay between a vehicle and a ground station with an impaired channel.

    python -m benchmarks.relay --vehicle 14550 --ground 14600 --condition c --seed 1

The relay listens on one port per end, and answers to the address of the last datagram; `--vehicle-at` is the
port of a vehicle that sends nothing before it receives a datagram. A channel determines what happens between
both ends (see `channels`). For a radio the relay also sends RADIO_STATUS to both ends once per second, from
system 51, component 68, as SiK radios do, with the free part of the queue towards the other end; `--silent`
disables it. The relay prints `ready`, runs until its standard input is closed, and then prints its counters
as JSON.
"""

from __future__ import annotations

import argparse
import json
import math
import selectors
import socket
import sys
from dataclasses import asdict, dataclass
from time import monotonic
from typing import TYPE_CHECKING

from mavstack import Encoder
from mavstack.dialects import ardupilotmega

from .channels import CONDITIONS, Channel, Direction

if TYPE_CHECKING:
    from collections.abc import Iterator

HOST = "127.0.0.1"
RADIO_SYSTEM, RADIO_COMPONENT = 51, 68
STATUS_INTERVAL = 1.0
MAVLINK_1, MAVLINK_2 = 0xFE, 0xFD
SIGNED = 0x01


@dataclass(slots=True)
class DirectionCounters:
    """Counters of one direction: sent, delivered, dropped and lost packets."""

    packets: int = 0
    bytes: int = 0
    delivered: int = 0
    delivered_bytes: int = 0
    overflowed: int = 0
    lost: int = 0


@dataclass(frozen=True, slots=True)
class Report:
    """Counters of both directions."""

    to_ground: DirectionCounters
    to_vehicle: DirectionCounters


class Relay:
    """Two sockets with a channel between them."""

    def __init__(self, channel: Channel, vehicle: int, ground: int, *, vehicle_at: int = 0) -> None:
        self.counters = {direction: DirectionCounters() for direction in Direction}
        self._channel = channel
        self._sockets = {Direction.TO_GROUND: _bind(ground), Direction.TO_VEHICLE: _bind(vehicle)}
        self._peers: dict[Direction, tuple[str, int]] = {}
        if vehicle_at:
            self._peers[Direction.TO_VEHICLE] = (HOST, vehicle_at)
        self._encoder = Encoder(system=RADIO_SYSTEM, component=RADIO_COMPONENT)

    def run(self, *, silent: bool) -> None:
        """Relay packets until standard input is closed."""
        selector = selectors.DefaultSelector()
        for direction, endpoint in self._sockets.items():
            selector.register(endpoint, selectors.EVENT_READ, direction.other)
        selector.register(sys.stdin, selectors.EVENT_READ, None)
        status_at = math.inf if silent else monotonic() + STATUS_INTERVAL
        while True:
            due = min(status_at, self._channel.next_timeout() or math.inf)
            wait = None if due == math.inf else max(0.0, due - monotonic())
            for key, _ in selector.select(wait):
                if key.data is None:
                    return
                self._receive(key.data)
            self._deliver(monotonic())
            if monotonic() >= status_at:
                status_at += STATUS_INTERVAL
                self._send_status()

    def close(self) -> Report:
        """Close the sockets, and return the counters."""
        for direction, endpoint in self._sockets.items():
            endpoint.close()
            self.counters[direction].lost = self._channel.lost(direction)
        return Report(self.counters[Direction.TO_GROUND], self.counters[Direction.TO_VEHICLE])

    def _receive(self, direction: Direction) -> None:
        """Read all waiting datagrams of one end, and send them through the channel."""
        counters = self.counters[direction]
        while (received := _read(self._sockets[direction.other])) is not None:
            datagram, self._peers[direction.other] = received
            for piece in split(datagram) if self._channel.splits_datagrams else (datagram,):
                counters.packets += 1
                counters.bytes += len(piece)
                counters.overflowed += not self._channel.send(direction, piece, monotonic())

    def _deliver(self, now: float) -> None:
        for direction, data in self._channel.receive(now):
            if self._write(direction, data):
                self.counters[direction].delivered += 1
                self.counters[direction].delivered_bytes += len(data)

    def _send_status(self) -> None:
        """Send each end the free part of its queue."""
        for direction in Direction:
            free_percent = self._channel.free_percent(direction)
            if free_percent is not None:
                status = ardupilotmega.RadioStatus(
                    rssi=200, remrssi=200, txbuf=free_percent, noise=50, remnoise=50
                )
                self._write(direction.other, self._encoder.encode(status))

    def _write(self, direction: Direction, data: bytes) -> bool:
        peer = self._peers.get(direction)
        if peer is None:
            return False
        try:
            self._sockets[direction].sendto(data, peer)
        except OSError:  # no program listens at the moment
            return False
        return True


def split(datagram: bytes) -> Iterator[bytes]:
    """Yield the MAVLink packets of a datagram; other bytes are one piece."""
    position = 0
    while position < len(datagram):
        size = _packet_size(datagram, position)
        yield datagram[position : position + size]
        position += size


def _packet_size(data: bytes, position: int) -> int:
    rest = len(data) - position
    if rest < 3 or data[position] not in (MAVLINK_1, MAVLINK_2):
        return rest
    if data[position] == MAVLINK_1:
        return min(rest, data[position + 1] + 8)
    return min(rest, data[position + 1] + (25 if data[position + 2] & SIGNED else 12))


def _bind(port: int) -> socket.socket:
    endpoint = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    endpoint.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 22)
    endpoint.setblocking(False)
    endpoint.bind((HOST, port))
    return endpoint


def _read(endpoint: socket.socket) -> tuple[bytes, tuple[str, int]] | None:
    try:
        data, peer = endpoint.recvfrom(65536)
    except BlockingIOError:
        return None
    except OSError:  # an ICMP error: the port of the other end is closed
        return None
    return data, peer


def main() -> None:
    """Run the relay until standard input is closed."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.relay", description="An impaired link over UDP."
    )
    parser.add_argument("--vehicle", type=int, default=14550, help="the port that the vehicle sends to")
    parser.add_argument(
        "--vehicle-at",
        type=int,
        default=0,
        help="port of a vehicle that sends nothing before it receives a datagram",
    )
    parser.add_argument("--ground", type=int, default=14600, help="the port that the ground station sends to")
    parser.add_argument("--condition", choices=list(CONDITIONS), default="a")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--silent", action="store_true", help="a radio without RADIO_STATUS")
    options = parser.parse_args()
    channel = CONDITIONS[options.condition][1](options.seed)
    relay = Relay(channel, options.vehicle, options.ground, vehicle_at=options.vehicle_at)
    print("ready", flush=True)
    try:
        relay.run(silent=options.silent or channel.free_percent(Direction.TO_GROUND) is None)
    except KeyboardInterrupt:
        pass
    finally:
        print(json.dumps(asdict(relay.close())), flush=True)


if __name__ == "__main__":
    main()
