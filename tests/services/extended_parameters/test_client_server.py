"""Extended parameters, client against server: values, long changes, refusals, bounds."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack import encode
from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError, ParameterDenied, ParameterTimeout
from mavstack.services import Address
from mavstack.services.extended_parameters import (
    ExtendedParameter,
    ExtendedParameterChanged,
    ExtendedParameterClient,
    ExtendedParameterServer,
    ExtendedParameterWritten,
    ExtendedSetStarted,
)
from mavstack.services.extended_parameters.value import encode as encode_value
from mavstack.services.extended_parameters.value import with_field
from mavstack.wire import Packet
from tests.services.extended_parameters.harness import CAMERA, ExtendedParameterHarness
from tests.services.network import GROUND

KIND = common.MavParamExtType
ACK = common.ParamAck
ROWS = {
    "CAM_MODE": ("video", None),
    "CAM_ISO": (400, KIND.UINT32),
    "CAM_EV": (0.5, None),
    "CAM_RAW": (b"\xff", None),
}


def set_packet(name: str, value, kind: int, sequence: int, source: Address = GROUND) -> Packet:
    message = with_field(
        common.ParamExtSet(target_system=1, target_component=100, param_id=name, param_type=kind),
        encode_value(value, kind),
    )
    data = encode(message, system=source.system, component=source.component, sequence=sequence)
    return Packet(data, common)


def test_all_come_with_their_types() -> None:
    harness = ExtendedParameterHarness(ROWS)
    harness.run(listing := harness.client.download(harness.network.now))
    assert {name: parameter.value for name, parameter in listing.result().items()} == {
        name: value for name, (value, _) in ROWS.items()
    }
    assert listing.result()["CAM_ISO"].type == KIND.UINT32
    assert harness.client.complete


def test_one_is_read_by_name_and_index() -> None:
    harness = ExtendedParameterHarness(ROWS)
    reads = [harness.client.get(which, harness.network.now) for which in ("CAM_ISO", 1)]
    harness.run(*reads)
    assert [read.result() for read in reads] == [ExtendedParameter("CAM_ISO", 400, KIND.UINT32)] * 2


def test_values_are_set_and_reported_to_all() -> None:
    harness = ExtendedParameterHarness(ROWS)
    sets = [
        harness.client.set("CAM_MODE", "photo", harness.network.now),
        harness.client.set("CAM_ISO", 800, harness.network.now),
        harness.client.set("CAM_EV", 0.1, harness.network.now),
        harness.client.set("CAM_RAW", b"\xfe\0\1", harness.network.now),
    ]
    harness.run(*sets)
    assert [operation.error for operation in sets] == [None] * 4
    assert sets[0].result().value == harness.server["CAM_MODE"] == "photo"
    assert harness.client.parameters["CAM_ISO"].value == harness.server["CAM_ISO"] == 800
    assert harness.server["CAM_EV"] == pytest.approx(0.1)
    assert harness.server["CAM_RAW"] == b"\xfe\0\1"
    assert len(harness.camera.events_of(ExtendedParameterWritten)) == 4
    assert harness.ground.events_of(ExtendedParameterChanged)


def test_a_refusal_is_denied_with_its_reason() -> None:
    harness = ExtendedParameterHarness(ROWS)
    harness.server.add("LOCKED", "x", handler=lambda _: ACK.FAILED)
    harness.server.add("PICKY", "x", handler=lambda _: ACK.VALUE_UNSUPPORTED)
    now = harness.network.now
    wrong = [
        harness.client.set("LOCKED", "y", now),
        harness.client.set("PICKY", "y", now),
        harness.client.set("CAM_ISO", 1.0, now, kind=KIND.REAL32),
        harness.client.set("NONE", 1, now, kind=KIND.INT32),
    ]
    assert harness.run(*wrong) < 1.0
    codes = [ACK.FAILED, ACK.VALUE_UNSUPPORTED, ACK.VALUE_UNSUPPORTED, ACK.VALUE_UNSUPPORTED]
    for operation, code in zip(wrong, codes, strict=True):
        assert isinstance(operation.error, ParameterDenied)
        assert operation.error.code == code
        assert code.name in str(operation.error)
    assert (harness.server["LOCKED"], harness.server["CAM_ISO"]) == ("x", 400)


def test_a_long_change_is_waited_for() -> None:
    harness = ExtendedParameterHarness()
    harness.server.add("FORMAT", 0, handler=lambda _: None)
    operation = harness.client.set("FORMAT", 1, harness.network.now)

    def finish() -> None:
        (event,) = harness.camera.events_of(ExtendedSetStarted)
        harness.server.complete(event.request, ACK.ACCEPTED, harness.network.now)
        harness.server.complete(event.request, ACK.FAILED, harness.network.now)
        harness.touch()

    harness.network.at(45.0, finish)
    assert 45.0 <= harness.run(operation) < 46.0
    assert operation.result().value == harness.server["FORMAT"] == 1
    assert operation.attempts == 1


def test_a_long_change_that_fails_is_denied() -> None:
    harness = ExtendedParameterHarness()
    harness.server.add("FORMAT", 0, handler=lambda _: None)
    operation = harness.client.set("FORMAT", 1, harness.network.now)
    harness.network.at(
        5.0,
        lambda: (
            harness.server.complete(harness.server.running[0], ACK.FAILED, harness.network.now),
            harness.touch(),
        ),
    )
    harness.run(operation)
    assert isinstance(operation.error, ParameterDenied)
    assert harness.server["FORMAT"] == 0


def test_a_long_change_that_falls_silent_ends_in_a_timeout() -> None:
    harness = ExtendedParameterHarness()
    harness.server.add("FORMAT", 0, handler=lambda _: None)
    operation = harness.client.set("FORMAT", 1, harness.network.now)

    def cut() -> None:
        for pipe in harness.pipes:
            pipe.cut = True

    harness.network.at(1.0, cut)
    harness.run(operation)
    assert isinstance(operation.error, ParameterTimeout)
    assert "no further answer" in str(operation.error)


def test_a_lost_end_of_a_long_change_is_seen_by_the_value() -> None:
    harness = ExtendedParameterHarness()
    harness.server.add("FORMAT", 0, handler=lambda _: None)
    operation = harness.client.set("FORMAT", 1, harness.network.now)

    def finish_unnoticed() -> None:
        harness.pipes[1].cut = True
        harness.server.complete(harness.server.running[0], ACK.ACCEPTED, harness.network.now)
        harness.touch()
        harness.network.at(0.5, lambda: setattr(harness.pipes[1], "cut", False))

    harness.network.at(1.0, finish_unnoticed)
    harness.run(operation)
    assert operation.result().value == 1


def test_a_repetition_is_not_carried_out_again() -> None:
    calls = []
    server = ExtendedParameterServer(CAMERA)
    server.add("FORMAT", 0, handler=calls.append)
    for sequence in (1, 2):
        server.receive(set_packet("FORMAT", 1, KIND.INT32, sequence), 10.0)
    server.receive(set_packet("FORMAT", 2, KIND.INT32, 3), 10.0)
    results = [item.message.param_result for item in server.messages_to_send(10.0)]
    assert results == [ACK.IN_PROGRESS, ACK.IN_PROGRESS, ACK.FAILED]
    assert len(calls) == 1
    server.complete(calls[0], ACK.FAILED, 11.0)
    server.receive(set_packet("FORMAT", 1, KIND.INT32, 4), 12.0)
    assert [item.message.param_result for item in server.messages_to_send(12.0)] == [ACK.FAILED] * 2
    assert len(calls) == 1
    server.receive(set_packet("FORMAT", 1, KIND.INT32, 5), 30.0)
    assert len(calls) == 2


def test_in_progress_is_sent_periodically() -> None:
    server = ExtendedParameterServer(CAMERA)
    server.add("FORMAT", 0, handler=lambda _: None)
    server.receive(set_packet("FORMAT", 1, KIND.INT32, 1), 10.0)
    list(server.messages_to_send(10.0))
    due = server.next_timeout()
    assert due == 12.0
    server.handle_timeout(due)
    assert [item.message.param_result for item in server.messages_to_send(due)] == [ACK.IN_PROGRESS]


def test_another_clients_value_is_not_taken_for_ours() -> None:
    client = ExtendedParameterClient(GROUND, CAMERA)
    operation = client.set("ISO", 5, 10.0, kind=KIND.INT32)

    def hear(value: int, sequence: int) -> None:
        ack = common.ParamExtAck(param_id="ISO", param_type=KIND.INT32, param_result=ACK.ACCEPTED)
        data = encode(
            with_field(ack, encode_value(value, KIND.INT32)), system=1, component=100, sequence=sequence
        )
        client.receive(Packet(data, common), 10.1)

    hear(7, 1)
    assert not operation.done
    assert client.parameters["ISO"].value == 7
    hear(5, 2)
    assert operation.result().value == 5


def test_a_flood_is_bounded() -> None:
    server = ExtendedParameterServer(CAMERA)
    for number in range(300):
        server.add(f"P{number}", number)
    for system in range(1, 255):
        source = Address(system, 190)
        for message in (
            common.ParamExtRequestList(target_system=1, target_component=100),
            common.ParamExtRequestRead(1, 100, "", system),
        ):
            data = encode(message, system=system, component=190)
            server.receive(Packet(data, common), 1.0)
        server.receive(set_packet("P1", system, KIND.INT32, 1, source), 1.0)
    assert len(server._lists) <= 32
    assert len(server._reads) <= 256
    assert len(server._set_filters) <= 256


def test_misuse_raises_at_once() -> None:
    server, client = ExtendedParameterServer(CAMERA), ExtendedParameterClient(GROUND, CAMERA)
    server.add("A", 1)
    for wrong in (
        lambda: server.add("A", 1),
        lambda: server.add("A" * 17, 1),
        lambda: server.add("B", "x" * 129),
        lambda: server.set("A", "text"),
        lambda: client.set("A", 300, 0.0, kind=KIND.UINT8),
        lambda: client.get(40000, 0.0),
        lambda: ExtendedParameterClient(GROUND, Address(1, 0)),
    ):
        with pytest.raises(InvalidArgumentError):
            wrong()


MESSAGES = [
    common.ParamExtValue,
    common.ParamExtAck,
    common.ParamExtSet,
    common.ParamExtRequestRead,
    common.ParamExtRequestList,
]


@given(
    st.lists(st.tuples(st.sampled_from(MESSAGES), st.binary(max_size=160), st.integers(0, 255)), max_size=12)
)
def test_any_payload_harms_neither_end(messages) -> None:
    client, server = ExtendedParameterClient(GROUND, CAMERA), ExtendedParameterServer(CAMERA)
    server.add("A", 1)
    server.add("B", "text", handler=lambda _: None)
    now = 100.0
    client.download(now)
    client.set("A", 2, now, kind=KIND.INT32)
    client.get(0, now)
    for kind, payload, sequence in messages:
        now += 0.1
        packet = Packet(
            encode(kind.from_payload(payload), system=1, component=100, sequence=sequence), common
        )
        for service in (client, server):
            service.receive(packet, now)
            list(service.messages_to_send(now))
            service.handle_timeout(now)
            service.events()
    assert isinstance(server["A"], int)
    assert isinstance(server["B"], str)
