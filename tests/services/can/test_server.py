"""The forwarding of a bus: one client, a filter, and its end."""

from __future__ import annotations

from math import nan

from mavstack.dialects import common
from mavstack.services import Address
from mavstack.services.can import CanFrame, CanFrameReceived, CanServer, to_message
from mavstack.services.command import Command, CommandServer
from tests.services.network import GROUND, START, VEHICLE
from tests.services.single_service import deliver, feed_random_messages, sent_by

STATUS = CanFrame(20 << 24 | 341 << 8 | 42, bytes(8))
OTHER = CanFrame(20 << 24 | 1063 << 8 | 42, bytes(8))


class Forwarding:
    def __init__(self) -> None:
        self.commands, self.server = CommandServer(VEHICLE), CanServer(VEHICLE, buses=2)
        self.server.answer(self.commands)

    def forward(self, bus: float, source: Address = GROUND, now: float = START) -> int:
        command = Command.of(common.MavCmd.CAN_FORWARD, (bus,))
        deliver(self.commands, command.to_long(VEHICLE), source, now)
        (ack,) = sent_by(self.commands, now)
        return ack.result

    def transmitted(self, *frames: CanFrame, bus: int = 1) -> list[int]:
        for frame in frames:
            self.server.transmit(bus, frame)
        return [message.id & 0x1FFFFFFF for message in sent_by(self.server)]

    def filter(self, operation: int, *ids: int) -> None:
        message = common.CanFilterModify(
            target_system=1, target_component=1, bus=1, operation=operation, num_ids=len(ids), ids=ids
        )
        deliver(self.server, message, GROUND, START)


def test_a_bus_is_forwarded_until_it_lapses():
    can = Forwarding()
    assert can.transmitted(STATUS) == []
    assert can.forward(1) == common.MavResult.ACCEPTED
    assert can.transmitted(STATUS) == [STATUS.id]
    assert can.transmitted(STATUS, bus=2) == []
    assert can.forward(1, now=START + 4) == common.MavResult.ACCEPTED
    can.server.handle_timeout(START + 6)
    assert can.transmitted(STATUS) == [STATUS.id]
    can.server.handle_timeout(can.server.next_timeout())
    assert can.transmitted(STATUS) == []


def test_wrong_buses_and_the_end():
    can = Forwarding()
    wrong = (3, -1, 1.5, nan)
    results = [can.forward(bus, now=START + n) for n, bus in enumerate(wrong)]
    assert results == [common.MavResult.FAILED] * 4
    can.forward(2, now=START + 4)
    assert can.transmitted(STATUS, bus=2) == [STATUS.id]
    assert can.forward(0, now=START + 5) == common.MavResult.ACCEPTED
    assert can.transmitted(STATUS, bus=2) == []


def test_filters():
    can = Forwarding()
    can.forward(1)
    can.filter(0, 341)
    assert can.transmitted(STATUS, OTHER) == [STATUS.id]
    can.filter(1, 1063)
    assert can.transmitted(STATUS, OTHER) == [STATUS.id, OTHER.id]
    can.filter(2, 341)
    assert can.transmitted(STATUS, OTHER) == [OTHER.id]
    can.forward(1, Address(254, 1), START + 1)  # another client begins without a filter
    assert can.transmitted(STATUS, OTHER) == [STATUS.id, OTHER.id]


def test_frames_of_clients():
    can = Forwarding()
    deliver(can.server, to_message(STATUS, 2, 1, 1), GROUND, START)
    deliver(can.server, to_message(STATUS, 3, 1, 1), GROUND, START)
    assert can.server.events() == [CanFrameReceived(2, STATUS)]


def test_random_messages():
    for seed in range(20):
        kinds = [common.CanFrame, common.CanfdFrame, common.CanFilterModify]
        feed_random_messages(CanServer(VEHICLE), kinds, seed)
