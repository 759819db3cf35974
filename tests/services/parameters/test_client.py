"""Reading and setting one parameter, the live cache, packed files, and garbage."""

from __future__ import annotations

from struct import pack

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack import encode
from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError, LocalProtocolError, ParameterDenied, ParameterTimeout
from mavstack.services import Address
from mavstack.services.parameters import (
    Encoding,
    Parameter,
    ParameterChanged,
    ParameterClient,
    ParameterRounded,
    ParameterServer,
    write,
)
from mavstack.services.parameters.value import NO_INDEX
from mavstack.wire import Packet
from tests.services.network import GROUND, VEHICLE, Network
from tests.services.parameters.harness import ParameterHarness
from tests.services.parameters.test_listing import ScriptedVehicle

KIND = common.MavParamType
ERROR = common.MavParamError


@pytest.mark.parametrize("encoding", Encoding)
def test_one_parameter_is_read_by_name_and_by_index(encoding) -> None:
    harness = ParameterHarness(20, encoding=encoding)
    name, value, kind = harness.rows[7]
    reads = [harness.client.get(which, harness.network.now) for which in (name, 7)]
    harness.run(*reads)
    assert [read.result() for read in reads] == [Parameter(name, value, kind)] * 2
    assert reads[0].result().index == 7


def test_a_name_of_16_characters_is_read_and_set() -> None:
    harness = ParameterHarness(0)
    harness.server.add("ABCDEFGHIJKLMNOP", 1.5)
    harness.run(set_ := harness.client.set("ABCDEFGHIJKLMNOP", 2.5, harness.network.now))
    assert set_.result().value == harness.server["ABCDEFGHIJKLMNOP"] == 2.5


@pytest.mark.parametrize("encoding", Encoding)
def test_a_value_is_set_and_read_back(encoding) -> None:
    harness = ParameterHarness(0, encoding=encoding)
    harness.server.add("SPEED", 1.0)
    harness.server.add("COUNT", 5, KIND.INT16)
    sets = [
        harness.client.set("SPEED", 0.1, harness.network.now),
        harness.client.set("COUNT", -300, harness.network.now),
    ]
    harness.run(*sets)
    assert sets[0].result().text == "0.1"
    assert sets[1].result() == Parameter("COUNT", -300, KIND.INT16)
    assert (harness.server["SPEED"], harness.server["COUNT"]) == (pytest.approx(0.1), -300)


def test_an_integer_that_a_cast_would_change_is_refused() -> None:
    harness = ParameterHarness(0, encoding=Encoding.C_CAST)
    harness.server.add("RTL_ALT", 5, KIND.INT32)
    harness.run(operation := harness.client.set("RTL_ALT", 99999999, harness.network.now))
    with pytest.raises(InvalidArgumentError, match=r"RTL_ALT cannot be set to 99999999.* become 100000000"):
        operation.result()
    assert harness.server["RTL_ALT"] == 5
    harness.run(operation := harness.client.set("RTL_ALT", 100000000, harness.network.now))
    assert operation.result() == Parameter("RTL_ALT", 100000000, KIND.INT32)
    assert not operation.result().exact


@pytest.mark.parametrize("encoding", Encoding)
def test_a_double_loses_digits_and_an_event_reports_it(encoding) -> None:
    harness = ParameterHarness(0, encoding=encoding)
    harness.server.add("PRECISE", 5.0, KIND.REAL64)
    harness.run(operation := harness.client.set("PRECISE", 16777217.0, harness.network.now))
    assert operation.result() == Parameter("PRECISE", 16777216.0, KIND.REAL64)
    assert harness.ground.events_of(ParameterRounded) == [ParameterRounded("PRECISE", 16777217.0, 16777216.0)]


def test_bytewise_loses_nothing() -> None:
    harness = ParameterHarness(0)
    harness.server.add("SERIAL", 5, KIND.INT32)
    for value in (16777217, 0x7F800001, -1, -(1 << 31)):
        harness.run(operation := harness.client.set("SERIAL", value, harness.network.now))
        assert operation.result().value == harness.server["SERIAL"] == value
        assert operation.result().exact
    assert harness.ground.events_of(ParameterRounded) == []


def test_a_type_that_is_given_saves_the_asking() -> None:
    harness = ParameterHarness(0)
    harness.server.add("X", 5, KIND.UINT8)
    harness.run(operation := harness.client.set("X", 9, harness.network.now, kind=KIND.UINT8))
    assert operation.result().value == 9
    assert [packet.name for packet in harness.vehicle.received] == ["PARAM_SET"]


def test_a_value_that_the_type_cannot_hold_is_our_own_error() -> None:
    harness = ParameterHarness(0)
    harness.server.add("X", 5, KIND.UINT8)
    harness.run(operation := harness.client.set("X", 256, harness.network.now))
    assert isinstance(operation.error, LocalProtocolError)
    assert "PARAM_SET" not in [packet.name for packet in harness.vehicle.received]


def test_a_param_error_is_denied_with_its_reason() -> None:
    harness = ParameterHarness(3)
    harness.server.add("FIXED", 1, read_only=True)
    harness.server.add("SMALL", 1, minimum=0, maximum=9)
    wrong = [
        harness.client.get("NO_SUCH", harness.network.now),
        harness.client.get(99, harness.network.now),
        harness.client.set("FIXED", 2, harness.network.now),
        harness.client.set("SMALL", 10, harness.network.now),
        harness.client.set("SMALL", 1.0, harness.network.now, kind=KIND.REAL32),
        harness.client.set("NO_SUCH", 10, harness.network.now),
    ]
    assert harness.run(*wrong) < 1.0
    codes = [
        ERROR.DOES_NOT_EXIST,
        ERROR.DOES_NOT_EXIST,
        ERROR.READ_ONLY,
        ERROR.VALUE_OUT_OF_RANGE,
        ERROR.TYPE_MISMATCH,
        ERROR.DOES_NOT_EXIST,
    ]
    for operation, code in zip(wrong, codes, strict=True):
        assert isinstance(operation.error, ParameterDenied)
        assert operation.error.code == code
        assert code.name in str(operation.error)
    assert (harness.server["FIXED"], harness.server["SMALL"]) == (1, 1)


def test_an_unknown_name_that_gets_silence_ends_in_a_timeout() -> None:
    vehicle = ScriptedVehicle()
    read = vehicle.client.get("NO_SUCH", vehicle.network.now)
    asked = vehicle.run(60.0)
    assert isinstance(read.error, ParameterTimeout)
    assert read.error.attempts == len(asked) == 6


@pytest.mark.parametrize(("which", "text"), [("NO_SUCH", "param: NO_SUCH"), (7, "param ID: 7")])
def test_an_unknown_name_that_gets_a_text_is_denied(which, text) -> None:
    vehicle = ScriptedVehicle()
    read = vehicle.client.get(which, vehicle.network.now)
    vehicle.run(0.1)
    vehicle.send(common.Statustext(severity=6, text="[pm] unknown param: NO_SUCH_OTHER"))
    vehicle.run(0.1)
    assert not read.done
    vehicle.send(common.Statustext(severity=6, text=f"[pm] unknown {text}"))
    vehicle.run(0.1)
    assert isinstance(read.error, ParameterDenied)
    assert read.error.code == ERROR.DOES_NOT_EXIST


def test_a_component_that_keeps_its_value_is_reported() -> None:
    vehicle = ScriptedVehicle()
    vehicle.send_value("X", 1.0, 0, 1)
    vehicle.run(0.1)
    operation = vehicle.client.set("X", 5.0, vehicle.network.now)
    for _ in range(60):
        if any(isinstance(message, common.ParamSet) for message in vehicle.run(0.1)):
            vehicle.send_value("X", 3.0, 0, 1)
    assert isinstance(operation.error, ParameterDenied)
    assert "the value stayed 3" in str(operation.error)


def test_an_old_value_that_comes_late_is_no_refusal() -> None:
    vehicle = ScriptedVehicle()
    vehicle.send_value("X", 1.0, 0, 1)
    vehicle.run(0.1)
    operation = vehicle.client.set("X", 5.0, vehicle.network.now)
    vehicle.run(0.01)
    vehicle.send_value("X", 1.0, 0, 1)
    vehicle.run(1.5)  # it is sent again
    assert not operation.done
    vehicle.send_value("X", 5.0, NO_INDEX, 1)
    vehicle.run(0.01)
    assert operation.result().value == 5.0
    assert operation.result().index is None
    assert vehicle.client.parameters["X"].index == 0


def test_a_component_that_answers_only_changes_is_requested_the_value() -> None:
    vehicle = ScriptedVehicle()
    operation = vehicle.client.set("X", 5.0, vehicle.network.now, kind=KIND.REAL32)
    for _ in range(30):
        if any(isinstance(message, common.ParamRequestRead) for message in vehicle.run(0.1)):
            vehicle.send_value("X", 5.0, NO_INDEX, 1)
    assert operation.result().value == 5.0


def test_sets_of_one_name_go_one_after_the_other() -> None:
    harness = ParameterHarness(0)
    harness.server.add("X", 0.0)
    sets = [harness.client.set("X", float(value), harness.network.now) for value in range(1, 6)]
    harness.run(*sets)
    assert [operation.result().value for operation in sets] == [1.0, 2.0, 3.0, 4.0, 5.0]
    assert harness.server["X"] == 5.0


def test_the_cache_follows_what_others_change() -> None:
    harness = ParameterHarness(0)
    harness.server.add("X", 1.0)
    harness.run(harness.client.download(harness.network.now))
    harness.server.set("X", 7.0)
    harness.touch()
    harness.network.run(timeout=0.1)
    assert harness.client.parameters["X"].value == 7.0
    first, second = harness.ground.events_of(ParameterChanged)
    assert (first.previous, second.previous) == (None, Parameter("X", 1.0))
    assert second.parameter == Parameter("X", 7.0)


def test_a_value_that_was_reordered_does_not_undo_a_newer_one() -> None:
    client = ParameterClient(GROUND, VEHICLE)
    for sequence, value in ((5, 1.0), (7, 3.0), (6, 2.0)):
        client.receive(value_packet("X", value, sequence), 100.0)
    assert client.parameters["X"].value == 3.0
    client.receive(value_packet("Y", 4.0, 4), 100.0)
    assert client.parameters["Y"].value == 4.0  # old, but better than nothing


def value_packet(name: str, value: float, sequence: int) -> Packet:

    message = common.ParamValue(param_id=name, param_value=value, param_type=KIND.REAL32, param_count=9)
    return Packet(encode(message, system=1, component=1, sequence=sequence), common)


def test_another_encoding_forgets_what_was_read() -> None:
    harness = ParameterHarness(5)
    harness.run(harness.client.download(harness.network.now))
    harness.client.encoding = Encoding.C_CAST
    assert (dict(harness.client.parameters), harness.client.complete) == ({}, False)


def test_a_packed_file_fills_the_cache() -> None:
    harness = ParameterHarness(0)
    for number in range(50):
        harness.server.add(f"P{number}", number, KIND.INT16, default=1)
    assert harness.client.load_packed(harness.server.table.packed(with_defaults=True, block_size=239), 1.0)
    assert harness.client.complete
    assert [parameter.value for parameter in harness.client.parameters.values()] == list(range(50))
    assert harness.client.defaults["P7"] == 1
    assert not harness.client.load_packed(b"nothing", 1.0)


def test_what_was_reported_during_a_download_is_newer_than_the_file() -> None:
    client = ParameterClient(GROUND, VEHICLE)
    client.receive(value_packet("OLD", 1.0, 1), 5.0)
    client.receive(value_packet("NEW", 1.0, 2), 15.0)
    file = write([Parameter("OLD", 2.0), Parameter("NEW", 2.0)])
    assert client.load_packed(file, 20.0, started_at=10.0)
    assert {name: parameter.value for name, parameter in client.parameters.items()} == {
        "OLD": 2.0,
        "NEW": 1.0,
    }


def test_misuse_raises_at_once() -> None:
    client = ParameterClient(GROUND, VEHICLE)
    with pytest.raises(InvalidArgumentError, match="one component"):
        ParameterClient(GROUND, Address(1, 0))
    with pytest.raises(InvalidArgumentError, match="1 to 16"):
        client.get("A" * 17, 0.0)
    with pytest.raises(InvalidArgumentError, match="1 to 16"):
        client.set("", 1, 0.0)
    with pytest.raises(InvalidArgumentError, match="index"):
        client.get(-1, 0.0)


MESSAGES = [
    common.ParamValue,
    common.ParamError,
    common.ParamSet,
    common.ParamRequestRead,
    common.ParamRequestList,
]


@given(
    st.lists(st.tuples(st.sampled_from(MESSAGES), st.binary(max_size=30), st.integers(0, 255)), max_size=12),
    st.sampled_from(Encoding),
)
def test_any_payload_harms_neither_end(messages, encoding) -> None:

    network = Network()
    client, server = ParameterClient(GROUND, VEHICLE, encoding), ParameterServer(VEHICLE, encoding)
    server.add("A", 1)
    server.add("B", 0.5, minimum=0.0, maximum=1.0)
    now = network.now
    client.download(now)
    client.set("A", 2, now)
    client.get(0, now)
    client.read_hash(now)
    for kind, payload, sequence in messages:
        now += 0.1
        message = kind.from_payload(payload)
        packet = Packet(encode(message, system=1, component=1, sequence=sequence), common)
        for service in (client, server):
            service.receive(packet, now)
            list(service.messages_to_send(now))
            service.handle_timeout(now)
            service.events()
    assert isinstance(server["A"], int)
    assert 0.0 <= server["B"] <= 1.0


def test_a_not_a_number_is_no_integer() -> None:
    server = ParameterServer(VEHICLE, Encoding.C_CAST)
    server.add("A", 1)

    payload = pack("<fBB16sB", float("nan"), 1, 1, b"A", KIND.INT32)
    packet = Packet(encode(common.ParamSet.from_payload(payload), system=255, component=190), common)
    server.receive(packet, 0.0)
    sent = [outgoing.message for outgoing in server.messages_to_send(0.0)]
    assert [type(message) for message in sent] == [common.ParamError, common.ParamValue]
    assert server["A"] == 1
