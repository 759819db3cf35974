"""The payload's bytes, the checksum, directory entries, missing ranges."""

from __future__ import annotations

from zlib import crc32

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.mavftp_op import FTP_OP

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services.ftp import Entry, FtpPayload, Opcode, file_crc32
from mavstack.services.ftp.entries import pack_entries, read_entries
from mavstack.services.ftp.missing_ranges import MissingRanges
from mavstack.services.ftp.payload import error_text, path_bytes

BYTES = st.integers(0, 255)


@given(
    st.integers(0, 65535),
    BYTES,
    BYTES,
    BYTES,
    st.booleans(),
    st.integers(0, 2**32 - 1),
    st.binary(max_size=239),
)
def test_the_same_bytes_as_pymavlink(sequence, session, opcode, req_opcode, complete, offset, data) -> None:
    ours = FtpPayload(sequence, opcode, session, len(data), req_opcode, complete, offset, data)
    theirs = FTP_OP(
        sequence, session, opcode, len(data), req_opcode, int(complete), offset, bytearray(data)
    ).pack()
    assert ours.to_bytes() == bytes(theirs)
    assert FtpPayload.read(ours.to_message(1, 1)) == ours


def test_the_checksum_is_not_zlibs() -> None:
    assert file_crc32(b"123456789") == 0x2DFD2D88
    assert file_crc32(b"123456789") != crc32(b"123456789")
    assert file_crc32(b"") == 0


@given(st.binary(), st.binary())
def test_the_checksum_of_pieces(one, other) -> None:
    register = 0
    for byte in one + other:
        register ^= byte
        for _ in range(8):
            register = register >> 1 ^ (0xEDB88320 if register & 1 else 0)
    assert file_crc32(other, file_crc32(one)) == file_crc32(one + other) == register


def test_an_errno_is_the_second_byte() -> None:
    nak = FtpPayload(1, Opcode.NAK, size=2, data=bytes([2, 13]))
    assert (nak.error, nak.errno) == (2, 13)
    assert FtpPayload(1, Opcode.NAK, size=1, data=bytes([10])).errno is None
    assert FtpPayload(1, Opcode.NAK).error == 1
    assert "errno 13" in error_text(2, 13)
    assert error_text(200) == "error 200"


def test_misuse_raises() -> None:
    for path in ("", "a\0b", "x" * 240):
        with pytest.raises(InvalidArgumentError):
            path_bytes(path)
    with pytest.raises(InvalidArgumentError):
        FtpPayload.request(Opcode.WRITEFILE, bytes(240))
    with pytest.raises(InvalidArgumentError):
        FtpPayload.request(Opcode.READFILE, offset=1 << 32)
    assert FtpPayload.read(common.Heartbeat()) is None


def test_entries_are_counted_even_if_they_cannot_be_reported() -> None:
    entries = [Entry("a", size=3), Entry("tab\there"), Entry("d", True), Entry("x" * 240), Entry("")]
    page = pack_entries(entries, 0)
    assert page == b"Fa\t3\0S\0Dd\0S\0S\0"
    found, count = read_entries(page)
    assert found == [Entry("a", size=3), Entry("d", True)]
    assert count == len(entries)


def test_entries_with_times() -> None:
    entries = [Entry("a", size=3, modified=1747459200), Entry("d", True, modified=5)]
    assert read_entries(pack_entries(entries, 0, with_time=True)) == (entries, 2)


@given(st.binary(max_size=239))
def test_any_page_is_read(page) -> None:
    found, count = read_entries(page)
    assert len(found) <= count


def test_the_ranges_after_the_end_of_one_begin_with_the_next() -> None:
    ranges = MissingRanges(5, 50)
    assert ranges.remove(20, 30) == [(20, 30)]
    assert list(ranges.after(20)) == [(30, 50)]
    assert list(ranges.after(19)) == [(19, 20), (30, 50)]


@given(st.lists(st.tuples(st.integers(0, 60), st.integers(0, 60))), st.integers(0, 60))
def test_ranges_are_a_set_of_bytes(pieces, position) -> None:
    ranges, missing = MissingRanges(5, 50), set(range(5, 50))
    for start, end in pieces:
        taken = {byte for low, high in ranges.remove(start, end) for byte in range(low, high)}
        assert taken == missing & set(range(start, end))
        missing -= taken
        assert {byte for low, high in ranges for byte in range(low, high)} == missing
        assert ranges.total == len(missing)
    assert all(low < high for low, high in ranges.after(position))
    after = {byte for low, high in ranges.after(position) for byte in range(low, high)}
    assert after == {byte for byte in missing if byte >= position}
