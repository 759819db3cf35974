"""CDR: byte for byte as another implementation writes it, and what is rejected."""

from __future__ import annotations

from random import Random
from typing import Any

import pytest

from mavstack.bridges.core.types import Definition, codec_of, definition_of, interface_names
from mavstack.bridges.core.types.cdr import flatten, nest
from mavstack.bridges.core.types.definitions import definition_text
from mavstack.errors import CdrError
from tests.bridges.core.types.random_values import random_values

MESSAGES = [
    name for name in interface_names("msg") if not definition_of(name).fields[0].name.startswith("str")
]
IMU = "sensor_msgs/msg/Imu"


@pytest.fixture(scope="module")
def typestore() -> Any:
    rosbags = pytest.importorskip("rosbags.typesys")
    store = rosbags.get_typestore(rosbags.Stores.ROS2_KILTED)
    missing: dict[str, Any] = {}
    for name in MESSAGES:
        if name not in store.types:
            missing |= rosbags.get_types_from_msg(definition_text(name), name)
    store.register(missing)
    return store


def as_rosbags(store: Any, definition: Definition, fields: dict[str, Any]) -> Any:
    """Return a message object of rosbags."""
    import numpy as np

    made = {}
    for field in definition.fields:
        value = fields[field.name]
        kind = field.type
        if kind.is_message:
            inner = definition_of(kind.base)
            value = (
                [as_rosbags(store, inner, each) for each in value]
                if isinstance(value, list)
                else as_rosbags(store, inner, value)
            )
        elif kind.container.value != "one" and kind.base != "string":
            types = {"byte": "uint8", "char": "uint8", "bool": "bool_"}
            value = np.array(list(value), dtype=getattr(np, types.get(kind.base, kind.base)))
        made[field.name] = list(value) if isinstance(value, tuple) else value
    return store.types[definition.name](**made)


@pytest.mark.parametrize("name", MESSAGES)
def test_bytes_are_those_of_rosbags(typestore: Any, name: str) -> None:
    rng = Random(name)
    definition = definition_of(name)
    for _ in range(3):
        values = random_values(name, rng)
        ours = codec_of(name).encode(values)
        theirs = typestore.serialize_cdr(as_rosbags(typestore, definition, nest(definition, values)), name)
        assert ours == bytes(theirs)


@pytest.mark.parametrize("name", interface_names("msg"))
def test_values_return(name: str) -> None:
    rng = Random(name)
    codec = codec_of(name)
    for _ in range(5):
        values = random_values(name, rng)
        payload = codec.encode(values)
        assert codec.decode(payload) == values
        assert codec.encode_fields(codec.decode_fields(payload)) == payload


def test_big_endian_is_read() -> None:
    payload = bytes.fromhex("00000000") + b"\x01\x02\x03\x04"
    assert codec_of("std_msgs/msg/UInt32").decode_fields(payload) == {"data": 0x01020304}


def test_a_header_of_one_frame_gives_the_same_bytes() -> None:
    for name in MESSAGES:
        if definition_of(name).has_header:
            values = random_values(name, Random(1))
            values[:3] = [12, 345, "base_link"]
            fast = codec_of(name).stamped("base_link")(12_000_000_345, values[3:])
            assert fast == codec_of(name).encode(values), name


def test_missing_fields_are_zero_or_empty() -> None:
    fields = nest(definition_of(IMU), flatten(definition_of(IMU), {}))
    assert fields["header"] == {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""}
    assert fields["orientation_covariance"] == [0] * 9


@pytest.mark.parametrize(
    ("fields", "problem"),
    [
        ({"nonsense": 1}, "no field 'nonsense'"),
        ({"orientation_covariance": [1.0]}, "must have 9 elements, got 1"),
        ({"header": {"stamp": {"sec": "x"}}}, "encoding sensor_msgs/msg/Imu failed"),
    ],
)
def test_wrong_fields(fields: dict[str, Any], problem: str) -> None:
    with pytest.raises(CdrError, match=problem):
        codec_of(IMU).encode_fields(fields)


@pytest.mark.parametrize("count", [0, 1, 200])
def test_a_wrong_number_of_values(count: int) -> None:
    with pytest.raises(CdrError, match="encoding"):
        codec_of(IMU).encode([0] * count)


def test_random_bytes_raise_nothing_else() -> None:
    rng = Random(5)
    for name in interface_names("msg"):
        codec = codec_of(name)
        good = codec.encode(random_values(name, rng))
        for _ in range(20):
            damaged = bytearray(good)
            for _ in range(rng.randrange(1, 5)):
                damaged[rng.randrange(len(damaged))] = rng.getrandbits(8)
            data = bytes(damaged[: rng.randrange(len(damaged) + 1)])
            try:
                codec.decode_fields(data)
            except CdrError:
                continue


def test_a_huge_count_is_refused_at_once() -> None:
    payload = b"\0\1\0\0" + b"\xff\xff\xff\xff" + bytes(16)
    with pytest.raises(CdrError, match="do not fit"):
        codec_of("tf2_msgs/msg/TFMessage").decode(payload)
