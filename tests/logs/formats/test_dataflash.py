"""Recognition of DataFlash logs, and the conformance tests of both formats."""

from __future__ import annotations

import pytest

import mavstack
from mavstack.logs.formats.dataflash import is_binary, is_text
from tests.logs.conformance import LogConformance
from tests.logs.dataflash.test_text_log import as_text
from tests.logs.dataflash.writer import LogWriter, flight


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


class TestBinary(LogConformance):
    format = "dataflash"

    def write(self, folder):
        path = folder / "log.tlog"
        path.write_bytes(bytes(flight(records=900).data))
        return path


class TestWithoutGps(LogConformance):
    format = "dataflash"
    has_start = False

    def write(self, folder):
        log = LogWriter()
        for number in range(300):
            log.write("ATT", 10_000 * number, *[number] * 6)
            log.write("IMU", 10_000 * number, number % 2, *[0.5] * 6)
        path = folder / "log.ulg"
        path.write_bytes(bytes(log.data))
        return path


class TestText(LogConformance):
    format = "dataflash-text"
    has_damage_when_truncated = False

    def write(self, folder):
        binary = TestBinary().write(folder)
        path = folder / "log.BIN"
        path.write_text(as_text(mavstack.open_log(binary)), "utf-8")
        return path


@pytest.mark.parametrize("lost", [(), (30,), (40, 41, 60), (0,)])
def test_logs_that_mavlink_router_received_block_by_block(tmp_path, lost):
    # A block of 200 bytes is written at its place; lost ones, and the rest of the last one, are zeros.
    data = bytes(flight(records=900).data)
    blocks = [data[at : at + 200].ljust(200, b"\0") for at in range(0, len(data), 200)]
    path = tmp_path / "00001-2024-05-01_10-00-00.bin"
    path.write_bytes(b"".join(bytes(200) if number in lost else block for number, block in enumerate(blocks)))
    whole = tmp_path / "whole.bin"
    whole.write_bytes(data)
    log, expected = mavstack.open_log(path), mavstack.open_log(whole)
    assert log.format == "dataflash"
    assert log.skipped.bad_bytes >= 200 * len(lost) + len(blocks) * 200 - len(data)
    times = expected["IMU"]["TimeUS"].tolist()
    kept = log["IMU"]["TimeUS"].tolist()
    assert len(times) - 6 * len(lost) <= len(kept) <= len(times)
    assert set(kept) <= set(times)
