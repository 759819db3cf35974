from __future__ import annotations

import json
from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.errors import InvalidArgumentError
from mavstack.server.rows.frame_decoder import FrameReader, parse_decoder

#: The pages of the station decode frames too: both pass the same cases.
CASES = json.loads((Path(__file__).parents[3] / "web/src/lib/frames/decoder-cases.json").read_text("utf-8"))
JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda children: (
        st.lists(children, max_size=3) | st.dictionaries(st.text(max_size=5), children, max_size=3)
    ),
    max_leaves=8,
)
NAMES = (
    "name",
    "endian",
    "framing",
    "checksum",
    "id",
    "messages",
    "fields",
    "type",
    "kind",
    "offset",
    "length",
)


@pytest.mark.parametrize("case", CASES["rows"], ids=lambda case: case["name"])
def test_frames(case: dict) -> None:
    data = bytes.fromhex(case["data"])
    is_stream = "framing" in case["decoder"]
    for size in (len(data), 1, 7) if is_stream else (len(data),):
        reader = FrameReader(parse_decoder(case["decoder"]))
        rows = [row for at in range(0, len(data), size) for row in reader.feed(data[at : at + size])]
        assert [{"message": row.message, "fields": row.fields} for row in rows] == case["rows"]
        assert reader.refused == case["refused"]


@pytest.mark.parametrize("number", range(len(CASES["refused"])))
def test_malformed_declarations(number: int) -> None:
    case = CASES["refused"][number]
    with pytest.raises(InvalidArgumentError, match="invalid decoder: ") as caught:
        parse_decoder(case["decoder"])
    assert case["problem"] in str(caught.value)


def test_frames_of_scripts_keep_their_bytes() -> None:
    (row,) = FrameReader(None).feed(b"\x01\x02")
    assert (row.message, row.fields, row.data) == ("FRAME", {"size": 2}, b"\x01\x02")


@given(st.dictionaries(st.sampled_from(NAMES), JSON) | JSON)
def test_any_json_is_a_decoder_or_an_error_of_the_user(value: object) -> None:
    with suppress(InvalidArgumentError):
        FrameReader(parse_decoder(value)).feed(bytes(100))


@given(st.sampled_from(CASES["rows"]), st.binary(max_size=400))
def test_any_bytes_are_rows_or_counted(case: dict, data: bytes) -> None:
    for row in FrameReader(parse_decoder(case["decoder"])).feed(data):
        json.dumps(dict(row.fields), allow_nan=False)
