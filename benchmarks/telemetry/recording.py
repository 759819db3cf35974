"""What a simulated vehicle sends: each packet, and when it is due, recorded in virtual time.

A simulated PX4 copter sends 374 packets a second by default, in steps of 20 ms, so about seven at a time.
Spread evenly they are the same packets one by one, which is what a receiver pays most for: it has to be
woken up for each.
"""

from __future__ import annotations

from typing import NamedTuple

from mavstack.dialects import Dialect
from mavstack.sim import Simulation
from mavstack.wire import Parser

SETTLE = 10.0  # seconds until everything is sent at its usual rate
HEARTBEAT = 0


class Due(NamedTuple):
    """A packet, when it is to be sent, in seconds, and the id of its message."""

    time: float
    data: bytes
    message_id: int


def record(seconds: float) -> list[Due]:
    """What the vehicle sends in that time, beginning a moment before a heartbeat."""
    simulation = Simulation()
    vehicle = simulation.add("copter", "px4")
    vehicle.open_port("recording")
    parser = Parser(Dialect.load("all"))
    begun, packets = simulation.now + SETTLE, list[Due]()
    while simulation.now < begun + seconds:
        simulation.advance(simulation.now + simulation.length)
        for _, data in vehicle.data_to_send():
            (packet,) = parser.feed(data)
            if packets or (simulation.now >= begun and packet.message_id == HEARTBEAT):
                packets.append(Due(simulation.now - begun, data, packet.message_id))
    return packets


def spread(packets: list[Due]) -> list[Due]:
    """The same packets, all the same time apart."""
    step = (packets[-1].time - packets[0].time) / (len(packets) - 1)
    return [each._replace(time=packets[0].time + place * step) for place, each in enumerate(packets)]
