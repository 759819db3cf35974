"""Recognition of DataFlash logs."""

from __future__ import annotations

import pytest

from mavstack.logs.dataflash.formats import is_binary, is_text

from .writer import flight


@pytest.mark.parametrize(
    ("head", "binary", "text"),
    [
        (b"", False, False),
        (b"\xa3\x95", False, False),
        (b"\xa3\x95\x80", True, False),
        (b"junk" + bytes(flight(records=1).data), True, False),
        (b"FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n", False, True),
        (b"\r\n7\r\nArduPlane\r\nFMT,128,89,FMT,BBnNZ,Type,Length\r\n", False, True),
        (b"a text about FMT, 128, 89, FMT,", False, False),
        (b"ULog\x01\x12\x35", False, False),
        (b"\xfd\x09\x00\x00" * 50, False, False),
    ],
)
def test_the_content_is_recognised(head, binary, text):
    assert (is_binary(head), is_text(head)) == (binary, text)


def test_a_tlog_of_a_log_download_is_no_dataflash_log():
    # LOG_DATA carries 90 bytes of the log in each packet.
    data = bytes(flight(records=10).data)
    packets = b"".join(b"\xfd" + bytes(9) + data[at : at + 90] + bytes(2) for at in range(0, 2000, 90))
    assert not is_binary(packets)
