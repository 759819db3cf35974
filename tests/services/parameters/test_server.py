"""Parameter server: lists, sets, refusals, bounds."""

from __future__ import annotations

from math import isnan
from struct import pack
from typing import TYPE_CHECKING, Any

import pytest

from mavstack import encode
from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services import BROADCAST, Address
from mavstack.services.parameters import (
    Encoding,
    Parameter,
    ParameterServer,
    ParameterWritten,
    unpack,
    write_upload,
)
from mavstack.services.parameters.server import MAX_LISTS, MAX_READS
from mavstack.services.parameters.value import NO_INDEX, read_value
from mavstack.wire import Packet
from tests.services.network import GROUND, VEHICLE

if TYPE_CHECKING:
    import builtins

KIND = common.MavParamType
ERROR = common.MavParamError
OTHER = Address(250, 190)


class Wire:
    """A server, and the packets that reach it."""

    def __init__(self, encoding: Encoding = Encoding.BYTEWISE, **options) -> None:
        self.server = ParameterServer(VEHICLE, encoding, **options)
        self.now = 1000.0
        self.sequence = 0

    def send(
        self, message, source: Address = GROUND, *, sequence: int | None = None, version: int = 2
    ) -> None:
        self.sequence = self.sequence + 1 if sequence is None else sequence
        data = encode(
            message,
            system=source.system,
            component=source.component,
            sequence=self.sequence % 256,
            version=version,
        )
        self.server.receive(Packet(data, common), self.now)

    def list(self, source: Address = GROUND) -> None:
        self.send(common.ParamRequestList(target_system=1, target_component=1), source)

    def read(self, which: str | int, source: Address = GROUND, **how) -> None:
        name, index = (which, -1) if isinstance(which, str) else ("", which)
        message = common.ParamRequestRead(
            target_system=1, target_component=1, param_id=name, param_index=index
        )
        self.send(message, source, **how)

    def set(self, name: str, data: bytes, kind: int, source: Address = GROUND, **how) -> None:
        payload = data + pack("<BB16sB", 1, 1, name.encode(), kind)
        self.send(common.ParamSet.from_payload(payload), source, **how)

    def sent(self, has_room=lambda *_: True) -> builtins.list[Any]:
        return list(self.server.messages_to_send(self.now, has_room))

    def all_sent(self) -> builtins.list[Any]:
        found = []
        while some := self.sent():
            found += some
            self.now += 0.1
            self.server.handle_timeout(self.now)
        return found


def names(outgoing) -> list[str]:
    return [item.message.param_id for item in outgoing]


def wire_with(number: int, **options) -> Wire:
    wire = Wire(**options)
    for index in range(number):
        wire.server.add(f"P{index:03d}", index)
    return wire


def test_a_list_begins_with_the_hash_and_goes_to_who_requested() -> None:
    wire = wire_with(3)
    wire.list()
    sent = wire.all_sent()
    assert names(sent) == ["_HASH_CHECK", "P000", "P001", "P002"]
    assert {item.target for item in sent} == {GROUND}
    assert [item.message.param_index for item in sent] == [NO_INDEX, 0, 1, 2]
    assert sent[0].message.to_payload()[:4] == pack("<I", wire.server.table.hash())


def test_a_list_is_sent_while_there_is_room() -> None:
    wire = wire_with(10, hash_check=False)
    wire.list()
    budget = iter([True, True, True])
    assert names(wire.sent(lambda *_: next(budget, False))) == ["P000", "P001", "P002"]
    assert names(wire.sent()) == [f"P{index:03d}" for index in range(3, 10)]


def test_a_list_leaves_in_bursts() -> None:
    wire = wire_with(100, hash_check=False)
    wire.list()
    assert len(wire.sent()) == 32
    assert wire.sent() == []
    due = wire.server.next_timeout()
    assert due is not None
    assert due > wire.now
    wire.now = due
    wire.server.handle_timeout(due)
    assert len(wire.sent()) == 32


def test_a_list_that_is_requested_again_begins_again() -> None:
    wire = wire_with(3)
    wire.list()
    budget = iter([True, True, True])
    wire.sent(lambda *_: next(budget, False))
    wire.list()
    assert names(wire.all_sent()) == ["P000", "P001", "P002"]


def test_several_clients_are_served_in_turns() -> None:
    wire = wire_with(3, hash_check=False)
    wire.list(GROUND)
    wire.list(OTHER)
    sent = wire.all_sent()
    assert [item.target for item in sent] == [GROUND, OTHER] * 3
    assert names(sent) == ["P000", "P000", "P001", "P001", "P002", "P002"]


def test_a_client_without_room_holds_up_no_client() -> None:
    wire = wire_with(3, hash_check=False)
    wire.list(GROUND)
    wire.list(OTHER)
    sent = wire.sent(lambda target, *_: target == OTHER)
    assert [item.target for item in sent] == [OTHER] * 3


def test_single_values_go_before_lists() -> None:
    wire = wire_with(5, hash_check=False)
    wire.list()
    wire.read("P004", OTHER)
    assert names(wire.sent())[0] == "P004"


def test_setting_the_hash_ends_the_list() -> None:
    wire = wire_with(5)
    wire.list()
    wire.set("_HASH_CHECK", b"\0\0\0\0", KIND.UINT32)
    (answer,) = wire.all_sent()
    assert (answer.message.error, answer.target) == (ERROR.READ_ONLY, GROUND)


def test_the_hash_is_read_by_its_name() -> None:
    wire = wire_with(5)
    wire.read("_HASH_CHECK")
    (answer,) = wire.sent()
    assert answer.message.param_id == "_HASH_CHECK"
    wire = wire_with(5, hash_check=False)
    wire.read("_HASH_CHECK")
    (answer,) = wire.sent()
    assert answer.message.error == ERROR.DOES_NOT_EXIST


def test_a_value_that_was_set_is_reported_to_all() -> None:
    wire = wire_with(2)
    wire.set("P001", pack("<i", 77), KIND.INT32)
    (answer,) = wire.sent()
    assert answer.target == BROADCAST
    assert read_value(answer.message, Encoding.BYTEWISE) == Parameter("P001", 77, KIND.INT32)
    assert wire.server.events() == [ParameterWritten(Parameter("P001", 77, KIND.INT32), 1, GROUND)]
    wire.server.set("P001", 78)
    wire.server.set("P001", 78)
    assert len(wire.sent()) == 1


def test_a_set_of_the_present_value_is_answered_without_an_event() -> None:
    wire = wire_with(2)
    wire.set("P001", pack("<i", 1), KIND.INT32)
    assert names(wire.sent()) == ["P001"]
    assert wire.server.events() == []


@pytest.mark.parametrize(
    ("name", "data", "kind", "error"),
    [
        ("NONE", pack("<i", 1), KIND.INT32, ERROR.DOES_NOT_EXIST),
        ("LIMITED", pack("<i", 11), KIND.INT32, ERROR.VALUE_OUT_OF_RANGE),
        ("LIMITED", pack("<i", -1), KIND.INT32, ERROR.VALUE_OUT_OF_RANGE),
        ("FIXED", pack("<i", 1), KIND.INT32, ERROR.READ_ONLY),
        ("LIMITED", pack("<f", 1.0), KIND.REAL32, ERROR.TYPE_MISMATCH),
        ("LIMITED", pack("<f", 1.0), 77, ERROR.TYPE_UNSUPPORTED),
        ("GAIN", pack("<f", float("nan")), KIND.REAL32, ERROR.VALUE_OUT_OF_RANGE),
        ("GAIN", pack("<f", float("inf")), KIND.REAL32, ERROR.VALUE_OUT_OF_RANGE),
        ("FREE", pack("<f", float("nan")), KIND.REAL32, ERROR.VALUE_OUT_OF_RANGE),
        ("FREE", pack("<f", float("-inf")), KIND.REAL32, ERROR.VALUE_OUT_OF_RANGE),
        ("GUARDED", pack("<i", 1), KIND.INT32, ERROR.PERMISSION_DENIED),
    ],
)
def test_what_cannot_be_set_is_refused_and_stays(name, data, kind, error) -> None:
    check = lambda definition, _: ERROR.PERMISSION_DENIED if definition.name == "GUARDED" else None  # noqa: E731
    wire = Wire(check=check)
    wire.server.add("LIMITED", 5, minimum=0, maximum=10)
    wire.server.add("FIXED", 5, read_only=True)
    wire.server.add("GAIN", 0.5, minimum=0.0, maximum=1.0)
    wire.server.add("GUARDED", 5)
    wire.server.add("FREE", 0.5)
    before = wire.server.table.parameters()
    wire.set(name, data, kind)
    sent = wire.sent()
    assert (sent[0].message.error, sent[0].message.param_id, sent[0].target) == (error, name, GROUND)
    assert sent[0].message.param_index == -1
    assert names(sent[1:]) == ([] if name == "NONE" else [name])
    assert wire.server.table.parameters() == before
    assert wire.server.events() == []


def test_a_parameter_whose_default_is_nan_can_be_set_to_nan() -> None:
    wire = Wire()
    wire.server.add("UNSET", 1.5, default=float("nan"))
    wire.set("UNSET", pack("<f", float("nan")), KIND.REAL32)
    assert isnan(wire.server["UNSET"])


def test_an_unknown_index_is_reported_with_its_number() -> None:
    wire = wire_with(2)
    wire.read(2)
    (answer,) = wire.sent()
    assert (answer.message.error, answer.message.param_index) == (ERROR.DOES_NOT_EXIST, 2)


def test_a_client_of_mavlink_1_gets_no_message_that_it_cannot_hear() -> None:
    wire = wire_with(2)
    wire.read("NONE", version=1)
    wire.server.add("FIXED", 5, read_only=True)
    wire.set("FIXED", pack("<i", 1), KIND.INT32, version=1)
    assert names(wire.sent()) == ["FIXED"]


def test_a_cast_value_is_taken_whatever_type_it_claims_and_rounded() -> None:
    wire = Wire(Encoding.C_CAST)
    wire.server.add("MODE", 5, KIND.INT8)
    for value, expected in ((7.0, 7), (7.6, 8), (300.0, 8), (float("nan"), 8), (127.0, 127)):
        wire.set("MODE", pack("<f", value), KIND.REAL32)
        assert wire.server["MODE"] == expected


def test_the_greatest_integer_can_be_set_by_a_cast() -> None:
    wire = Wire(Encoding.C_CAST)
    wire.server.add("BITS", 0, KIND.INT32)
    wire.set("BITS", pack("<f", float(2**31 - 1)), KIND.INT32)
    assert wire.server["BITS"] == 2**31 - 1


def test_an_old_wish_that_comes_late_does_not_undo_a_newer_one() -> None:
    wire = wire_with(1)
    wire.set("P000", pack("<i", 1), KIND.INT32, sequence=10)
    wire.set("P000", pack("<i", 2), KIND.INT32, sequence=12)
    wire.set("P000", pack("<i", 1), KIND.INT32, sequence=11)
    assert wire.server["P000"] == 2
    wire.now += 1.0
    wire.set("P000", pack("<i", 3), KIND.INT32, sequence=5)
    assert wire.server["P000"] == 3


def test_a_flood_of_clients_is_bounded() -> None:
    wire = wire_with(300, hash_check=False)
    for number in range(1, 250):
        wire.list(Address(number, 190))
        wire.set("P000", pack("<i", number), KIND.INT32, Address(number, 1))
        for index in range(3):
            wire.read(index, Address(number, 2))
    server = wire.server
    assert (len(server._lists), len(server._reads)) == (MAX_LISTS, MAX_READS)
    assert len(server._set_filters) <= 256


def test_a_table_without_parameters_ignores_the_list() -> None:
    wire = Wire()
    wire.list()
    assert wire.all_sent() == []


def test_a_written_packed_file_sets_what_may_be_set() -> None:
    wire = wire_with(3)
    wire.server.add("FIXED", 1, read_only=True)
    rows = [
        Parameter("P001", 50, KIND.INT32),
        Parameter("FIXED", 9, KIND.INT32),
        Parameter("NONE", 9, KIND.INT32),
    ]
    assert wire.server.load_packed(write_upload(rows), GROUND)
    assert (wire.server["P001"], wire.server["FIXED"]) == (50, 1)
    assert not wire.server.load_packed(write_upload(rows)[:-1], GROUND)
    assert len(wire.server.events()) == 1


def test_a_part_of_the_table_is_packed() -> None:
    wire = wire_with(10)
    packed = unpack(wire.server.table.packed(start=3, count=4), start=3)
    assert packed is not None
    assert [parameter.name for parameter in packed.parameters] == ["P003", "P004", "P005", "P006"]
    assert (packed.total, packed.complete) == (10, False)


def test_misuse_raises_at_once() -> None:
    server = wire_with(1).server
    for wrong in (
        lambda: server.add("P000", 1),
        lambda: server.add("A" * 17, 1),
        lambda: server.add("X", 300, KIND.INT8),
        lambda: server.add("_HASH_CHECK", 1),
        lambda: server.add("X", 1, 99),
        lambda: server.set("P000", 1.5),
        lambda: server.table.remove("NONE"),
    ):
        with pytest.raises(InvalidArgumentError):
            wrong()
