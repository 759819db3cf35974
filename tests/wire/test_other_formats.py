"""Files of other formats are refused with the name of their format."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.errors import LogError
from mavstack.logs import open_log
from mavstack.wire.other_formats import other_format
from tests.logs.files import encoded, stamped


@pytest.mark.parametrize(
    ("head", "name"),
    [
        (b"\x1f\x8b\x08\x00", "a gzip archive: unpack it first"),
        (b"PK\x03\x04\x14", "a ZIP archive: unpack it first"),
        (b"\x89MCAP0\r\n", "an MCAP recording"),
    ],
)
def test_another_format_is_refused_by_name(tmp_path, head, name):
    path = tmp_path / "x.ulg"
    path.write_bytes(head + bytes(1000))
    with pytest.raises(LogError) as raised:
        open_log(path)
    assert str(raised.value) == f"cannot open {path}: this is {name}"


@pytest.mark.parametrize(
    ("head", "name"),
    [
        (b"ULog\x01\x12\x35\x01" + bytes(8), "a PX4 ULog (mavstack.open_log reads it)"),
        (b"\xa3\x95\x80\x80\x59FMT", "an ArduPilot dataflash log (mavstack.open_log reads it)"),
        (b"FMT, 128, 89, FMT, BBnNZ", "an ArduPilot dataflash log as text (mavstack.open_log reads it)"),
    ],
)
def test_other_logs_have_names_where_packets_are_needed(head, name):
    assert other_format(head) == name


def test_streams_of_packets_have_no_other_format():
    packets = encoded([common.Heartbeat()])
    for head in (
        b"",
        b"U",
        stamped(packets),
        packets[0],
        encoded([common.Heartbeat()], version=1)[0],
        b"text\n",
    ):
        assert other_format(head) is None
