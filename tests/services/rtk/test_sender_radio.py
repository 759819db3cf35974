"""Corrections over a half-duplex radio of 57,600 baud: what they cost commands, in virtual time."""

from __future__ import annotations

from random import Random

from mavstack.dialects import common
from mavstack.services.command import Command, CommandClient, CommandOperation, CommandServer
from mavstack.services.rtk import ChannelPace, CorrectionReceiver, CorrectionSender
from tests.gnss.test_rtcm import msm, station
from tests.services.network import GROUND, VEHICLE, HalfDuplexRadio, Network

BANDWIDTH, SECONDS = 5760.0, 120
#: Two constellations and the station: about 800 bytes a second.
EPOCH_SIZES = ((1074, 420), (1084, 350))


class Delays:
    """Round trips of commands at random times, with telemetry, and with corrections or without."""

    def __init__(self, *, corrected: bool) -> None:
        self.network = network = Network(seed=3)
        ground, vehicle = network.node(GROUND), network.node(VEHICLE)
        network.connect(ground, vehicle, radio=HalfDuplexRadio(BANDWIDTH), bandwidth=BANDWIDTH)
        paces = [ChannelPace("wire", BANDWIDTH)]
        self.sender = ground.engine.add(CorrectionSender(GROUND, lambda: paces))
        self.receiver = vehicle.engine.add(CorrectionReceiver(VEHICLE))
        self.client = ground.engine.add(CommandClient(GROUND, VEHICLE))
        server = vehicle.engine.add(CommandServer(VEHICLE))
        server.support(common.MavCmd.DO_SET_HOME, lambda request: common.MavResult.ACCEPTED)
        self.ground, self.vehicle = ground, vehicle
        self.times: list[float] = []
        self._open: list[tuple[CommandOperation, float]] = []
        random = Random(1)
        for second in range(SECONDS):
            if corrected:
                network.at(second, lambda second=second: self.correct(second))
            network.at(second + random.random() * 0.9, self.command)
            for part in range(20):
                network.at(second + part / 20, self.report)

    def correct(self, second: int) -> None:
        data = station().data + b"".join(msm(number, second, size).data for number, size in EPOCH_SIZES)
        self.sender.feed(data, self.network.now)
        self.ground.engine.touch(self.sender)

    def command(self) -> None:
        now = self.network.now
        operation = self.client.begin(CommandOperation(Command.of(common.MavCmd.DO_SET_HOME, ())), now)
        self._open.append((operation, now))
        self.ground.engine.touch(self.client)

    def report(self) -> None:
        self.vehicle.engine.send(common.Attitude(time_boot_ms=1, roll=0.1, yaw=1.0), self.network.now)

    def run(self) -> list[float]:
        def collect() -> bool:
            for item in [item for item in self._open if item[0].done]:
                self._open.remove(item)
                self.times.append(self.network.now - item[1])
            return False

        self.network.run(collect, timeout=SECONDS + 5)
        assert len(self.times) == SECONDS
        return sorted(self.times)


def test_commands_are_hardly_delayed():
    without, corrected = Delays(corrected=False), Delays(corrected=True)
    before, after = without.run(), corrected.run()
    growth = after[int(0.95 * SECONDS)] - before[int(0.95 * SECONDS)]
    assert 0 < growth <= 0.05, growth
    counts = corrected.sender.counts
    assert counts.data / SECONDS > 790
    assert (counts.late, counts.sent) == (0, counts.frames - counts.thinned)
    assert corrected.receiver.received == counts.sent
