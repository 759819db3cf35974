"""The packets that a simulated vehicle sends and their times, recorded in virtual time.

A simulated PX4 copter sends 374 packets per second by default, in steps of 20 ms, about seven at a time.
Evenly spread, the same packets come one by one, which has the highest cost for a receiver, because it wakes
up for each.
"""

from __future__ import annotations

from typing import NamedTuple

from mavstack.dialects import Dialect
from mavstack.sim import Simulation
from mavstack.wire import Parser

SETTLE_TIME = 10.0  # seconds until all messages have their normal rate
HEARTBEAT = 0


class TimedPacket(NamedTuple):
    """A packet, its time of sending in seconds, and its message id."""

    time: float
    data: bytes
    message_id: int


def record(seconds: float) -> list[TimedPacket]:
    """Record the packets of a vehicle for a number of seconds, beginning shortly before a heartbeat."""
    simulation = Simulation()
    vehicle = simulation.add("copter", "px4")
    vehicle.open_port("recording")
    parser = Parser(Dialect.load("all"))
    begun, packets = simulation.now + SETTLE_TIME, list[TimedPacket]()
    while simulation.now < begun + seconds:
        simulation.advance(simulation.now + simulation.step_length)
        for _, data in vehicle.data_to_send():
            (packet,) = parser.feed(data)
            if packets or (simulation.now >= begun and packet.message_id == HEARTBEAT):
                packets.append(TimedPacket(simulation.now - begun, data, packet.message_id))
    return packets


def spread(packets: list[TimedPacket]) -> list[TimedPacket]:
    """Return the same packets at equal intervals."""
    step = (packets[-1].time - packets[0].time) / (len(packets) - 1)
    return [each._replace(time=packets[0].time + index * step) for index, each in enumerate(packets)]
