from __future__ import annotations

from random import Random

from mavstack.dialects import common
from mavstack.services import Address
from mavstack.services.serial_control import ShellClosed, ShellInput, ShellOpened, ShellServer
from mavstack.services.serial_control.messages import EXCLUSIVE, MULTI, REPLY, RESPOND, message
from mavstack.services.serial_control.server import MAX_PENDING
from tests.services.network import GROUND, VEHICLE
from tests.services.single_service import deliver, random_message, sent_by

OTHER = Address(250, 190)
OPEN = RESPOND | EXCLUSIVE | MULTI


def ask(data: bytes = b"", flags: int = OPEN) -> common.SerialControl:
    return message(VEHICLE, 10, flags, data)


def owned() -> ShellServer:
    server = ShellServer(VEHICLE)
    deliver(server, ask(), GROUND, 0.0)
    assert server.events() == [ShellOpened(GROUND, 0)]
    return server


def test_the_owner_gets_the_output_in_pieces_of_seventy():
    server = owned()
    server.feed(b"a" * 150)
    out = sent_by(server, 0.0)
    assert [(m.flags, m.count) for m in out] == [(REPLY, 70), (REPLY, 70), (REPLY, 10)]
    assert (out[0].target_system, out[0].target_component) == GROUND


def test_input_is_reported_once_though_its_packet_comes_twice():
    server = owned()
    for sequence in (1, 1, 2):
        deliver(server, ask(b"ls\n"), GROUND, 1.0, sequence)
    assert server.events() == [ShellInput(GROUND, b"ls\n")] * 2


def test_an_exclusive_owner_is_not_disturbed_until_it_lets_go():
    server = owned()
    deliver(server, ask(b"rm\n"), OTHER, 1.0)
    deliver(server, ask(flags=0), OTHER, 1.0, 1)
    assert (server.owner, server.refused, server.events()) == (GROUND, 2, [])
    deliver(server, ask(flags=0), GROUND, 2.0, 1)
    assert (server.owner, server.events()) == (None, [ShellClosed(GROUND)])
    deliver(server, ask(b"ls\n"), OTHER, 3.0, 2)
    assert server.events() == [ShellOpened(OTHER, 0), ShellInput(OTHER, b"ls\n")]


def test_an_owner_that_vanished_gives_way_when_another_asks():
    server = owned()
    deliver(server, ask(), OTHER, 29.0)
    assert server.owner == GROUND
    server.feed(b"old")
    deliver(server, ask(), OTHER, 30.0, 1)
    assert server.events() == [ShellClosed(GROUND), ShellOpened(OTHER, 0)]
    assert sent_by(server, 30.0) == []  # what was meant for the first is not for the second


def test_one_that_is_not_exclusive_gives_way_at_once():
    server = ShellServer(VEHICLE)
    deliver(server, ask(flags=RESPOND), GROUND, 0.0)
    deliver(server, ask(flags=RESPOND), OTHER, 0.1)
    assert server.owner == OTHER


def test_the_last_input_may_come_with_the_closing_message():
    server = owned()
    deliver(server, ask(b"reboot\n", flags=0), GROUND, 1.0, 1)
    assert server.events() == [ShellInput(GROUND, b"reboot\n"), ShellClosed(GROUND)]


def test_an_reordered_packet_neither_opens_nor_closes():
    server = owned()
    deliver(server, ask(flags=0), GROUND, 1.0, 9)
    deliver(server, ask(b"late\n"), GROUND, 1.1, 8)
    assert server.owner is None
    deliver(server, ask(), GROUND, 1.2, 11)
    deliver(server, ask(flags=0), GROUND, 1.3, 10)
    assert server.owner == GROUND


def test_without_an_owner_output_goes_nowhere():
    server = ShellServer(VEHICLE)
    server.feed(b"boot log")
    deliver(server, ask(), GROUND, 0.0)
    assert sent_by(server, 0.0) == []


def test_output_that_finds_no_room_is_bounded_and_the_newest_stays():
    server = owned()
    for number in range(2 * MAX_PENDING // 10):
        server.feed(b"%09d\n" % number)
    assert server.dropped > 0
    assert sent_by(server, 0.0, lambda target, priority=2: False) == []
    out = b"".join(m.data[: m.count] for m in sent_by(server, 0.0))
    assert len(out) <= MAX_PENDING
    assert out.endswith(b"%09d\n" % (2 * MAX_PENDING // 10 - 1))
    assert len(out) + server.dropped == 2 * MAX_PENDING // 10 * 10


def test_replies_and_other_devices_are_not_input():
    server = owned()
    deliver(server, ask(b"x", REPLY | OPEN), GROUND, 1.0, 1)
    deliver(server, message(VEHICLE, 0, OPEN, b"x"), GROUND, 1.0, 2)
    assert server.events() == []


def test_the_program_may_end_it():
    server = owned()
    server.feed(b"bye")
    server.close()
    server.close()
    assert server.events() == [ShellClosed(GROUND)]
    assert sent_by(server, 0.0) == []


def test_garbage_from_the_wire_never_raises_and_sources_are_bounded():
    server, random = ShellServer(VEHICLE), Random(6)
    for number in range(3000):
        data = random_message(common.SerialControl, random)
        source = Address(random.randrange(1, 256), random.randrange(1, 256))
        deliver(server, data.replace(device=random.choice([10, data.device])), source, number / 50)
    assert len(server._arrivals) <= 32
    assert all(len(e.data) <= 70 for e in server.events() if isinstance(e, ShellInput))
