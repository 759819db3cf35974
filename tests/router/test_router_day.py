"""A day of traffic in virtual time: every packet goes where it should, nothing grows, no alarm is false."""

from __future__ import annotations

from itertools import count
from typing import TYPE_CHECKING

import pytest

from mavstack._core import PacketRouter
from mavstack.dialects import common
from mavstack.router.config import Table
from mavstack.router.config.names import Names
from mavstack.router.firewall import Firewall, read_firewall
from tests.router.firewall.packets import Sender as Encoding
from tests.router.firewall.packets import command, ground_heartbeat, heartbeat

if TYPE_CHECKING:
    from mavstack.wire import Packet

resource = pytest.importorskip("resource")

DAY, HOUR = 86_400, 3600
#: Growth of the process after the first hour in kilobytes.
MAX_GROWTH = 8_000
#: Rare messages, which a firewall sees.
RARE = {"HEARTBEAT", "COMMAND_LONG", "COMMAND_ACK"}


class Day:
    """A vehicle over two radios of a group, a ground station, and a tablet that comes and goes."""

    def __init__(self) -> None:
        self.router = PacketRouter(common)
        self.radios = [self.router.add_port("radio") for _ in range(2)]
        self.ground, self.tablet = self.router.add_port(), self.router.add_port()
        table = Table.parse('[firewall]\ndefault = "allow"\n', "x").table("firewall")
        self.firewall = Firewall(read_firewall(table, Names("common")))
        for name in ("radio", "ground", "tablet"):
            self.firewall.open_endpoint(name)

    def send(self, name: str, port: int, packet: Packet, now: float) -> set[int]:
        """Route a packet, after the firewall has passed it."""
        if packet.name in RARE:
            assert self.firewall.decide(name, packet, now)
        return set(self.router.route(port, packet.raw, now))

    def from_vehicle(self, packet: Packet, now: float) -> set[int]:
        """Send a packet over both radios; the second copy goes nowhere."""
        reached = self.send("radio", self.radios[0], packet, now)
        assert not self.send("radio", self.radios[1], packet, now + 0.02)
        return reached

    def reopen_tablet(self) -> None:
        """Let the tablet leave and come back."""
        self.router.remove_port(self.tablet)
        self.tablet = self.router.add_port()


def run(seconds: int) -> None:
    day, vehicle, pilot = Day(), Encoding(1, 1), Encoding(255, 190)
    others = (Encoding(2 + number % 250, 1 + number % 200) for number in count())
    memory = 0
    for second in range(seconds):
        now = 1_790_000_000.0 + second
        stations = {day.ground, day.tablet}
        assert day.from_vehicle(vehicle.packet(heartbeat(armed=second % 900 > 60)), now) == stations
        for step in range(4):
            assert day.from_vehicle(vehicle.packet(common.Attitude()), now + 0.2 * step) == stations
        reached = day.send("ground", day.ground, pilot.packet(ground_heartbeat()), now)
        assert reached == {*day.radios, day.tablet}
        if second % 10 == 5:
            asked = day.send("ground", day.ground, pilot.packet(command(512, 148)), now + 0.5)
            assert asked == set(day.radios)
            answer = common.CommandAck(command=512, target_system=255, target_component=190)
            assert day.from_vehicle(vehicle.packet(answer), now + 0.6) == {day.ground}
        if second % 7 == 3:  # systems that come and go, of which a table could grow
            passing = next(others).packet(ground_heartbeat())
            assert day.send("tablet", day.tablet, passing, now + 0.7) == {*day.radios, day.ground}
        if second % HOUR == HOUR - 1:
            day.reopen_tablet()
            memory = memory or resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        assert [str(alert) for alert in day.firewall.alerts()] == []
    assert not memory or resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - memory < MAX_GROWTH


def test_ten_minutes():
    run(600)


@pytest.mark.nightly
def test_a_day():
    run(DAY)
