from __future__ import annotations

import json
import os
import random
from ctypes import CDLL
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services.remote_id import decode_broadcast, encode_broadcast, encode_pack
from tests.services.remote_id import opendroneid

LIBRARY = os.environ.get("MAVSTACK_OPENDRONEID", "")
VECTORS = json.loads((Path(__file__).parent / "vectors.json").read_text("utf-8"))
RANDOM_MESSAGES = int(os.environ.get("MAVSTACK_OPENDRONEID_MESSAGES", "20000"))


def message_of(name: str, fields: dict) -> object:
    values = {
        key: bytes.fromhex(each[4:]) if str(each).startswith("hex:") else each for key, each in fields.items()
    }
    return getattr(common, name)(**values)


def random_message(numbers: random.Random) -> object:
    """Return a message with values of the whole range of each field."""
    text = "".join(chr(numbers.randint(33, 126)) for _ in range(numbers.randint(0, 20)))
    altitude = lambda: numbers.choice([-1000.0, 31_767.5, numbers.uniform(-1000, 31_767)])  # noqa: E731
    place = numbers.randint(-900_000_000, 900_000_000), numbers.randint(-1_800_000_000, 1_800_000_000)
    nibble = lambda top=15: numbers.randint(0, top)  # noqa: E731
    match numbers.randint(0, 5):
        case 0:
            return common.OpenDroneIdBasicId(
                id_type=nibble(4), ua_type=nibble(), uas_id=text.encode().ljust(20, b"\0")
            )
        case 1:
            return common.OpenDroneIdLocation(
                status=nibble(4), direction=numbers.choice([36_100, numbers.randint(0, 36_000)]),
                speed_horizontal=numbers.choice([25_500, numbers.randint(0, 25_425)]),
                speed_vertical=numbers.choice([6300, numbers.randint(-6200, 6200)]),
                latitude=place[0], longitude=place[1], altitude_barometric=altitude(),
                altitude_geodetic=altitude(), height_reference=nibble(1), height=altitude(),
                horizontal_accuracy=nibble(), vertical_accuracy=nibble(), barometer_accuracy=nibble(),
                speed_accuracy=nibble(), timestamp_accuracy=nibble(),
                timestamp=numbers.choice([65_535.0, numbers.uniform(0, 3600)]),
            )  # fmt: skip
        case 2:
            page = nibble()
            return common.OpenDroneIdAuthentication(
                authentication_type=nibble(5), data_page=page, last_page_index=0 if page else 15,
                length=0 if page else numbers.randint(0, 255),
                timestamp=0 if page else numbers.getrandbits(32),
                authentication_data=numbers.randbytes(23 if page else 17).ljust(23, b"\0"),
            )  # fmt: skip
        case 3:
            return common.OpenDroneIdSelfId(description_type=nibble(), description=text)
        case 4:
            return common.OpenDroneIdSystem(
                operator_location_type=nibble(2), classification_type=nibble(7), operator_latitude=place[0],
                operator_longitude=place[1], area_count=numbers.getrandbits(16),
                area_radius=numbers.randint(0, 2550), area_ceiling=altitude(), area_floor=altitude(),
                category_eu=nibble(), class_eu=nibble(), operator_altitude_geo=altitude(),
                timestamp=numbers.getrandbits(32),
            )  # fmt: skip
    return common.OpenDroneIdOperatorId(operator_id_type=nibble(), operator_id=text)


@pytest.mark.parametrize("vector", VECTORS, ids=lambda vector: vector["name"])
def test_vectors(vector):
    message = message_of(vector["message"], vector["fields"])
    assert encode_broadcast(message).hex() == vector["bytes"]


@given(st.integers(0, 2**32))
def test_a_decoded_message_is_encoded_to_the_same_bytes(seed):
    data = encode_broadcast(random_message(random.Random(seed)))
    (message,) = decode_broadcast(data)
    assert encode_broadcast(message) == data


def test_units_of_a_location():
    sent = common.OpenDroneIdLocation(
        direction=26_950, speed_horizontal=6450, speed_vertical=-149, height=12.5, timestamp=1800.04
    )
    (read,) = decode_broadcast(encode_broadcast(sent))
    assert (read.direction, read.speed_horizontal, read.speed_vertical) == (27_000, 6450, -100)
    assert (read.height, read.timestamp) == (12.5, pytest.approx(1800.0))


def test_packs():
    messages = [random_message(random.Random(seed)) for seed in range(9)]
    data = encode_pack(messages)
    assert (len(data), data[:3].hex()) == (228, "f21909")
    assert [encode_broadcast(each) for each in decode_broadcast(data)] == [
        encode_broadcast(m) for m in messages
    ]
    for count in (0, 10):
        with pytest.raises(InvalidArgumentError):
            encode_pack([messages[0]] * count)
    for damaged in (
        data[:-1],
        data[:2],
        bytes([0xF2, 24, 1]) + bytes(25),
        bytes([0xF2, 25, 10]) + bytes(250),
    ):
        with pytest.raises(InvalidArgumentError):
            decode_broadcast(damaged)


@given(st.binary(max_size=240))
def test_any_bytes_are_read_or_refused(data):
    try:
        decode_broadcast(data)
    except InvalidArgumentError:
        assert len(data) < 25 or data[0] >> 4 == 15


def test_other_messages_are_refused():
    with pytest.raises(InvalidArgumentError, match="Heartbeat is not a message of Remote ID"):
        encode_broadcast(common.Heartbeat())
    with pytest.raises(InvalidArgumentError, match="0 to 15"):
        encode_broadcast(common.OpenDroneIdBasicId(id_type=16))
    assert decode_broadcast(bytes([0x62]) + bytes(24)) == []


@pytest.mark.interop
@pytest.mark.skipif(not LIBRARY, reason="MAVSTACK_OPENDRONEID does not name the library opendroneid-core-c")
def test_the_library_makes_the_same_bytes():
    library, numbers = CDLL(LIBRARY), random.Random(1)
    for _ in range(RANDOM_MESSAGES):
        message = random_message(numbers)
        assert encode_broadcast(message) == opendroneid.encode(library, message), message
