"""Every row of the table: messages of MAVLink to bytes of ROS, and bytes of ROS to messages."""

from __future__ import annotations

import json
import math
from collections import Counter
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING, Any

import pytest

from mavstack.bridges.core.inbound import Inbound
from mavstack.bridges.core.mapper import Mapper
from mavstack.bridges.core.table import ACTIONS, ALL, PUBLICATIONS, SERVICES, SUBSCRIPTIONS
from mavstack.bridges.core.topic import Topic
from mavstack.bridges.core.types import codec_of, definition_of
from mavstack.bridges.core.types.cdr import nest
from mavstack.bridges.core.view import VehicleView
from mavstack.dialects import Message, common
from mavstack.errors import InvalidArgumentError, MavstackError
from mavstack.services import Address
from tests.bridges.core.types.random_values import random_values

if TYPE_CHECKING:
    from mavstack.bridges.core.row import Publication, Subscription

MAVROS = json.loads(Path(__file__).with_name("mavros_names.json").read_text("utf-8"))
#: Rows that hardly any random message has a sample for: its frame or its time must be a certain one.
RARE = ("odometry/in", "time_reference")
CONVERTED = [row for row in PUBLICATIONS if row.convert is not None]


def random_message(kind: type[Message], rng: Random) -> Message:
    """Return a message with random bytes in its payload, as a damaged or hostile sender may send it."""
    size = len(kind().to_payload())
    return kind.from_payload(rng.randbytes(size))


def view_of(latest: dict[type, Message]) -> VehicleView:
    return VehicleView(latest.get, arrival=1_700_000_000_000_000_000)


def test_names_are_unique() -> None:
    twice = [name for (name, _), count in Counter((row.name, type(row)) for row in ALL).items() if count > 1]
    assert twice == []


def test_types_are_defined() -> None:
    for row in ALL:
        assert definition_of(row.type).fields


@pytest.mark.parametrize("row", CONVERTED, ids=lambda row: row.name)
def test_any_message_becomes_a_valid_sample(row: Publication) -> None:
    rng = Random(row.name)
    topic = Topic(row, row.name, "frame")
    samples: list[bytes] = []
    topic.add_receiver(lambda payload, stamp: samples.append(payload))
    for _ in range(30):
        for source in row.sources or (None,):
            latest = {kind: random_message(kind, rng) for kind in row.sources if rng.random() < 0.4}
            message = None if source is None else random_message(source, rng)
            mapper = Mapper(view_of(latest), [topic])
            mapper.receive(message, 1_700_000_000_000_000_000, [topic])
    assert topic.failed == 0
    assert samples or row.name in RARE
    for payload in samples:
        fields = codec_of(row.type).decode_fields(payload)
        assert codec_of(row.type).encode_fields(fields) == payload


@pytest.mark.parametrize("row", SUBSCRIPTIONS, ids=lambda row: row.name)
def test_no_sample_raises_anything_unexpected(row: Subscription) -> None:
    """Random samples give messages or one of our errors; the inlet counts both."""
    rng = Random(row.name)
    definition = definition_of(row.type)
    inbound = Inbound(Address(1, 1), view_of({}), now=1_700_000_000_000_000_000)
    for _ in range(50):
        fields = nest(definition, random_values(row.type, rng))
        try:
            messages = row.receive(fields, inbound)
        except (MavstackError, ValueError, OverflowError):
            continue
        assert all(isinstance(message, row.targets or Message) for message in messages)
        assert all(message.to_payload() is not None for message in messages)


def test_rows_have_the_types_and_profiles_of_mavros() -> None:
    """The counts that the documentation states; a difference is named in the row."""
    profiles = {"sensor": "S", "state": "K", "latched": "L", "parameters": "P"}
    found = Counter()
    for kind, rows in (
        ("publishers", PUBLICATIONS),
        ("subscriptions", SUBSCRIPTIONS),
        ("services", SERVICES),
    ):
        ours = {row.name: row for row in rows}
        for name, (type_name, profile) in MAVROS[kind].items():
            row: Any = ours.get(name)
            if row is None:
                continue
            assert row.type == type_name, name
            qos = getattr(row, "qos", None)
            if qos is not None and profiles.get(qos.name, str(qos.depth)) != profile:
                assert row.difference, f"{name}: {qos.name} instead of {profile}"
            found[kind] += 1
    assert found == {"publishers": 91, "subscriptions": 46, "services": 51}


def test_rows_beyond_mavros_are_marked() -> None:
    known = {*MAVROS["publishers"], *MAVROS["subscriptions"], *MAVROS["services"], *MAVROS["others"]}
    unnamed = [
        row.name
        for row in (*PUBLICATIONS, *SUBSCRIPTIONS, *SERVICES)
        if row.name not in known and "not in MAVROS" not in row.difference
    ]
    assert unnamed == []
    assert len(ACTIONS) == 5


def test_unknown_values_are_nan() -> None:
    row = next(row for row in PUBLICATIONS if row.name == "battery")
    message = common.BatteryStatus(
        id=0, voltages=[0xFFFF] * 10, current_battery=-1, battery_remaining=-1, temperature=0x7FFF
    )
    values: Any = row.convert(message, view_of({}))
    assert all(math.isnan(value) for value in values[:3])
    assert math.isnan(values[6])


def test_a_setpoint_with_nan_is_refused() -> None:
    row = next(row for row in SUBSCRIPTIONS if row.name == "setpoint_velocity/cmd_vel_unstamped")
    vector = {"x": math.nan, "y": 0.0, "z": 0.0}
    zero = dict.fromkeys("xyz", 0.0)
    with pytest.raises(InvalidArgumentError, match="finite"):
        row.receive({"linear": vector, "angular": zero}, Inbound(Address(1, 1), view_of({})))
