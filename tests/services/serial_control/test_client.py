from __future__ import annotations

from random import Random

import pytest

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services import Address
from mavstack.services.serial_control import ShellClient, ShellOutput, ShellReleased
from mavstack.services.serial_control.client import MAX_PENDING, OPEN_ATTEMPTS
from mavstack.services.serial_control.messages import EXCLUSIVE, MULTI, REPLY, RESPOND
from tests.services.network import GROUND, VEHICLE
from tests.services.single_service import deliver, random_message, run_timers, sent_by

OPEN = RESPOND | EXCLUSIVE | MULTI


def reply(data: bytes, count: int | None = None, **fields) -> common.SerialControl:
    return common.SerialControl(
        device=10, flags=REPLY, count=len(data) if count is None else count, data=data, **fields
    )


def opened() -> ShellClient:
    client = ShellClient(GROUND, VEHICLE)
    client.open(0.0)
    sent_by(client, 0.0)
    deliver(client, reply(b"nsh> "), VEHICLE, 0.1)
    client.events()
    return client


def test_opening_asks_for_a_prompt_until_something_comes_back():
    client = ShellClient(GROUND, VEHICLE)
    client.open(0.0)
    (message,) = sent_by(client, 0.0)
    assert (message.device, message.flags, message.count) == (10, OPEN, 0)
    assert (message.target_system, message.target_component) == VEHICLE
    assert [time for time, _ in run_timers(client, 2.5)] == [1.0, 2.0]
    deliver(client, reply(b"nsh> "), VEHICLE, 2.6)
    assert client.events() == [ShellOutput(b"nsh> ")]
    assert run_timers(client, 60.0) == []


def test_opening_ends_after_some_attempts():
    client = ShellClient(GROUND, VEHICLE)
    client.open(0.0)
    assert len([*sent_by(client, 0.0), *run_timers(client, 60.0)]) == OPEN_ATTEMPTS


def test_lines_are_cut_at_their_ends_and_every_byte_is_sent_in_order():
    client = opened()
    text = b"help\nver all\n" + b"x" * 200 + b"\nls\n"
    client.write(text, 1.0)
    chunks = [message.data[: message.count] for message in sent_by(client, 1.0)]
    assert b"".join(chunks) == text
    assert chunks[0] == b"help\nver all\n"
    assert max(map(len, chunks)) == 70
    assert chunks[-1] == b"ls\n" or chunks[-1].endswith(b"\nls\n")


def test_a_line_ends_with_a_newline():
    client = opened()
    client.write_line("ver all", 1.0)
    (message,) = sent_by(client, 1.0)
    assert message.data[: message.count] == b"ver all\n"
    assert message.flags == OPEN


def test_closing_sends_what_waits_then_lets_go_several_times():
    client = opened()
    client.write_line("reboot", 1.0)
    client.close(1.0)
    first = sent_by(client, 1.0)
    out = [*first, *(message for _, message in run_timers(client, 60.0))]
    assert [message.flags for message in out] == [OPEN, 0, 0, 0]
    assert client.events() == [ShellReleased()]
    assert client.next_timeout() is None
    client.close(70.0)
    assert sent_by(client, 70.0) == []


def test_closing_waits_for_room_and_does_not_spin():
    client = opened()
    client.write_line("reboot", 1.0)
    client.close(1.0)
    assert sent_by(client, 1.0, lambda target, priority=2: False) == []
    assert client.next_timeout() is None
    assert [message.flags for message in sent_by(client, 2.0)] == [OPEN, 0]


def test_a_packet_that_comes_twice_is_reported_once_but_the_same_text_twice():
    client = opened()
    for sequence in (5, 5, 6):
        deliver(client, reply(b"tick\n"), VEHICLE, 1.0, sequence)
    assert client.events() == [ShellOutput(b"tick\n")] * 2


def test_what_was_reordered_is_marked():
    client = opened()
    for sequence in (5, 7, 6):
        deliver(client, reply(b"%d" % sequence), VEHICLE, 1.0, sequence)
    assert client.events() == [ShellOutput(b"5"), ShellOutput(b"7"), ShellOutput(b"6", late=True)]


def test_other_devices_other_sources_and_requests_are_not_output():
    client = opened()
    deliver(client, reply(b"x").replace(device=0), VEHICLE, 1.0, 1)
    deliver(client, reply(b"x").replace(flags=RESPOND), VEHICLE, 1.0, 2)
    deliver(client, reply(b"x"), Address(9, 1), 1.0, 3)
    deliver(ShellClient(GROUND, VEHICLE), reply(b"x"), VEHICLE, 1.0, 4)
    assert client.events() == []


def test_a_count_that_exceeds_the_field_is_clamped():
    client = opened()
    deliver(client, reply(b"y" * 70, count=255), VEHICLE, 1.0, 1)
    assert client.events() == [ShellOutput(b"y" * 70)]


def test_a_port_that_answers_only_when_requested_is_polled():
    client = ShellClient(GROUND, VEHICLE, 2, baudrate=57600, poll=0.5)
    client.open(0.0)
    sent_by(client, 0.0)
    deliver(client, reply(b"x").replace(device=2), VEHICLE, 0.1)
    out = run_timers(client, 3.0)
    assert [time for time, _ in out] == [1.0, 1.5, 2.0, 2.5, 3.0]
    assert {(message.baudrate, message.device) for _, message in out} == {(57600, 2)}


def test_writing_without_bound_is_our_own_misuse():
    client = opened()
    with pytest.raises(InvalidArgumentError):
        client.write(b"\n" * 70 * (MAX_PENDING + 1), 1.0)
    assert client.waiting == 0


def test_garbage_from_the_wire_never_raises():
    client, random = opened(), Random(5)
    for number in range(3000):
        message = random_message(common.SerialControl, random)
        deliver(
            client,
            message.replace(device=random.choice([10, message.device])),
            VEHICLE,
            number / 50,
            number % 256,
        )
    assert all(0 < len(event.data) <= 70 for event in client.events())
