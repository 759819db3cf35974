"""Both encodings, against pymavlink where it has them, and what a float32 does to integers."""

from __future__ import annotations

from math import isnan, nan
from struct import pack, unpack

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink import mavparm

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services.parameters import Encoding, Parameter, encoding_of
from mavstack.services.parameters.value import (
    as_type,
    decode,
    encode,
    field_of,
    fitted,
    limits,
    read_value,
    same,
    shortest,
    survives,
    with_field,
)

KIND = common.MavParamType
CAPABILITY = common.MavProtocolCapability
BYTEWISE, CAST = CAPABILITY.PARAM_ENCODE_BYTEWISE, CAPABILITY.PARAM_ENCODE_C_CAST
ARDUPILOT, PX4 = common.MavAutopilot.ARDUPILOTMEGA, common.MavAutopilot.PX4
INTEGERS = [kind for kind in KIND if kind not in (KIND.REAL32, KIND.REAL64)]
SHORT = [kind for kind in INTEGERS if kind not in (KIND.UINT64, KIND.INT64)]


@pytest.mark.parametrize(
    ("capabilities", "autopilot", "encoding"),
    [
        (BYTEWISE, ARDUPILOT, Encoding.BYTEWISE),
        (CAST, PX4, Encoding.C_CAST),
        (0, PX4, Encoding.BYTEWISE),
        (0, ARDUPILOT, Encoding.C_CAST),
        (BYTEWISE | CAST, PX4, Encoding.BYTEWISE),
        (BYTEWISE | CAST, ARDUPILOT, Encoding.C_CAST),
        (0, common.MavAutopilot.INVALID, Encoding.BYTEWISE),
    ],
)
def test_the_encoding_follows_from_capabilities_or_autopilot(capabilities, autopilot, encoding) -> None:
    assert encoding_of(capabilities, autopilot) is encoding


@pytest.mark.parametrize("kind", SHORT)
@given(data=st.data())
def test_bytewise_integers_come_back_as_they_were(kind, data) -> None:
    value = data.draw(st.integers(*limits(kind)))
    assert decode(encode(value, kind, Encoding.BYTEWISE), kind, Encoding.BYTEWISE) == value


def test_an_integer_that_is_a_signalling_nan_passes_through_a_message() -> None:
    value = 0x7F800001
    message = with_field(common.ParamValue(param_id="X", param_type=KIND.INT32), pack("<i", value))
    assert field_of(message) == pack("<i", value)
    again = common.ParamValue.from_payload(message.to_payload())
    assert read_value(again, Encoding.BYTEWISE).value == value


@pytest.mark.parametrize("kind", INTEGERS)
@given(data=st.data())
def test_cast_integers_survive_up_to_24_bits(kind, data) -> None:
    smallest, largest = limits(kind)
    value = data.draw(st.integers(max(smallest, -(1 << 24)), min(largest, 1 << 24)))
    assert survives(value, kind, Encoding.C_CAST)


def test_a_cast_loses_integers_over_24_bits() -> None:
    lossy = decode(encode(16777217, KIND.INT32, Encoding.C_CAST), KIND.INT32, Encoding.C_CAST)
    assert lossy == 16777216
    assert not survives(16777217, KIND.INT32, Encoding.C_CAST)


@pytest.mark.parametrize("kind", INTEGERS)
def test_the_greatest_integers_of_a_type_stay_within_it(kind) -> None:
    for limit in limits(kind):
        found = decode(encode(limit, kind, Encoding.C_CAST), kind, Encoding.C_CAST)
        assert fitted(found, kind) is not None


@given(st.binary(min_size=4, max_size=4), st.integers(0, 255), st.sampled_from(Encoding))
def test_any_bytes_are_some_value(data, kind, encoding) -> None:
    value = decode(data, kind, encoding)
    assert isinstance(value, int | float)
    if kind in INTEGERS:
        assert limits(kind)[0] <= value <= limits(kind)[1]


class PymavlinkConnection:
    """Catches what pymavlink's MAVParmDict would send."""

    def __init__(self) -> None:
        self.sent: list[bytes] = []

    def param_set_send(self, _name, value, parm_type=None) -> None:
        self.sent.append(pack("<f", value))

    def recv_match(self, **_arguments):
        return None


@pytest.mark.parametrize("kind", SHORT)
def test_bytewise_values_are_those_of_pymavlink(kind, monkeypatch) -> None:
    monkeypatch.setattr(mavparm.time, "time", iter(range(100)).__next__)
    for value in (0, 1, 100):
        connection = PymavlinkConnection()
        mavparm.MAVParmDict().mavset(connection, "NAME", value, retries=1, parm_type=int(kind))
        assert encode(value, kind, Encoding.BYTEWISE) == connection.sent[0]


def test_a_name_of_16_characters_has_no_nul() -> None:
    name = "ABCDEFGHIJKLMNOP"
    message = common.ParamValue(param_id=name, param_type=KIND.REAL32, param_count=1)
    assert name.encode() + bytes([KIND.REAL32]) in message.to_payload()
    assert read_value(message, Encoding.BYTEWISE).name == name


def test_an_index_beyond_the_count_is_no_index() -> None:
    message = common.ParamValue(param_id="X", param_count=3, param_index=65535)
    assert read_value(message, Encoding.BYTEWISE).index is None


def test_values_that_a_type_cannot_hold() -> None:
    assert fitted(300, KIND.INT8) is None
    assert fitted(1.5, KIND.INT32) is None
    assert fitted(nan, KIND.INT32) is None
    assert fitted(2.0, KIND.INT8) == 2
    with pytest.raises(InvalidArgumentError, match="UINT8"):
        as_type("X", -1, KIND.UINT8)


@given(st.floats(width=32))
def test_the_shortest_text_reads_back(value) -> None:
    held = unpack("<f", pack("<f", float(shortest(value))))[0]
    assert same(held, value)


def test_text_and_nan() -> None:
    assert Parameter("X", unpack("<f", pack("<f", 0.1))[0]).text == "0.1"
    assert Parameter("X", 5, KIND.INT8).text == "5"
    assert same(nan, nan)
    assert isnan(decode(b"\0\0\xc0\x7f", KIND.REAL32, Encoding.BYTEWISE))
