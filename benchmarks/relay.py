"""A UDP relay between a vehicle and a ground station that is as bad as a link can be.

    python -m benchmarks.relay --vehicle 14550 --ground 14600 --condition c --seed 1

Both ends are heard on a port each, and answered where their last datagram came from; `--vehicle-at` names a
vehicle that waits to be spoken to. What happens between them is a channel's (see `channels`). A radio also
tells both ends, once a second, how much of the queue towards the other end is free: RADIO_STATUS from system
51, component 68, as SiK radios do; `--silent` switches that off. It prints `ready`, runs until its standard
input is closed, and then prints what it carried as JSON.
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
STATUS_PERIOD = 1.0
MAVLINK_1, MAVLINK_2 = 0xFE, 0xFD
SIGNED = 0x01


@dataclass(slots=True)
class Carried:
    """What one direction carried: everything sent into it, what came out, and what did not."""

    packets: int = 0
    bytes: int = 0
    delivered: int = 0
    delivered_bytes: int = 0
    overflowed: int = 0
    lost: int = 0


@dataclass(frozen=True, slots=True)
class Report:
    """What a relay carried each way."""

    to_ground: Carried
    to_vehicle: Carried


class Relay:
    """Two sockets and a channel between them."""

    def __init__(self, channel: Channel, vehicle: int, ground: int, *, vehicle_at: int = 0) -> None:
        self.carried = {way: Carried() for way in Direction}
        self._channel = channel
        self._sockets = {Direction.TO_GROUND: _bound(ground), Direction.TO_VEHICLE: _bound(vehicle)}
        self._peers: dict[Direction, tuple[str, int]] = {}
        if vehicle_at:
            self._peers[Direction.TO_VEHICLE] = (HOST, vehicle_at)
        self._encoder = Encoder(system=RADIO_SYSTEM, component=RADIO_COMPONENT)

    def run(self, *, silent: bool) -> None:
        """Carry packets until standard input is closed."""
        selector = selectors.DefaultSelector()
        for way, endpoint in self._sockets.items():
            selector.register(endpoint, selectors.EVENT_READ, way.other)
        selector.register(sys.stdin, selectors.EVENT_READ, None)
        status_at = math.inf if silent else monotonic() + STATUS_PERIOD
        while True:
            due = min(status_at, self._channel.next_timeout() or math.inf)
            wait = None if due == math.inf else max(0.0, due - monotonic())
            for key, _ in selector.select(wait):
                if key.data is None:
                    return
                self._take(key.data)
            self._deliver(monotonic())
            if monotonic() >= status_at:
                status_at += STATUS_PERIOD
                self._tell_status()

    def close(self) -> Report:
        """Give the ports back, and tell what was carried."""
        for way, endpoint in self._sockets.items():
            endpoint.close()
            self.carried[way].lost = self._channel.lost(way)
        return Report(self.carried[Direction.TO_GROUND], self.carried[Direction.TO_VEHICLE])

    def _take(self, way: Direction) -> None:
        """Read all that waits at one end, and send it on its way."""
        carried = self.carried[way]
        while (heard := _read(self._sockets[way.other])) is not None:
            datagram, self._peers[way.other] = heard
            for piece in split(datagram) if self._channel.splits else (datagram,):
                carried.packets += 1
                carried.bytes += len(piece)
                carried.overflowed += not self._channel.send(way, piece, monotonic())

    def _deliver(self, now: float) -> None:
        for way, data in self._channel.receive(now):
            if self._write(way, data):
                self.carried[way].delivered += 1
                self.carried[way].delivered_bytes += len(data)

    def _tell_status(self) -> None:
        """Tell each end how much room its own queue has."""
        for way in Direction:
            free = self._channel.free(way)
            if free is not None:
                status = ardupilotmega.RadioStatus(rssi=200, remrssi=200, txbuf=free, noise=50, remnoise=50)
                self._write(way.other, self._encoder.encode(status))

    def _write(self, way: Direction, data: bytes) -> bool:
        peer = self._peers.get(way)
        if peer is None:
            return False
        try:
            self._sockets[way].sendto(data, peer)
        except OSError:  # nobody is there at the moment
            return False
        return True


def split(datagram: bytes) -> Iterator[bytes]:
    """The MAVLink packets of a datagram; what is none goes on as it is."""
    at = 0
    while at < len(datagram):
        size = _packet_size(datagram, at)
        yield datagram[at : at + size]
        at += size


def _packet_size(data: bytes, at: int) -> int:
    rest = len(data) - at
    if rest < 3 or data[at] not in (MAVLINK_1, MAVLINK_2):
        return rest
    if data[at] == MAVLINK_1:
        return min(rest, data[at + 1] + 8)
    return min(rest, data[at + 1] + (25 if data[at + 2] & SIGNED else 12))


def _bound(port: int) -> socket.socket:
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
    except OSError:  # the other end's port is closed, as the system tells after a send
        return None
    return data, peer


def main() -> None:
    """Relay until standard input is closed."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.relay", description="A bad link over UDP.")
    parser.add_argument("--vehicle", type=int, default=14550, help="the port that the vehicle sends to")
    parser.add_argument("--vehicle-at", type=int, default=0, help="the port of a vehicle that waits")
    parser.add_argument("--ground", type=int, default=14600, help="the port that the ground station sends to")
    parser.add_argument("--condition", choices=list(CONDITIONS), default="a")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--silent", action="store_true", help="a radio without RADIO_STATUS")
    options = parser.parse_args()
    channel = CONDITIONS[options.condition][1](options.seed)
    relay = Relay(channel, options.vehicle, options.ground, vehicle_at=options.vehicle_at)
    print("ready", flush=True)
    try:
        relay.run(silent=options.silent or channel.free(Direction.TO_GROUND) is None)
    except KeyboardInterrupt:
        pass
    finally:
        print(json.dumps(asdict(relay.close())), flush=True)


if __name__ == "__main__":
    main()
