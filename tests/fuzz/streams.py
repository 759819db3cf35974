"""Fuzz target of the streams of receivers and casters, by its name in `STREAMS`.

Any bytes, in any chunks, give what they give at once, raise nothing but the errors of the contract, and
do not hide a message that follows them. Run by `rust/fuzz/run` as
`python -m tests.fuzz.streams NAME`; needs `pip install atheris`.
"""

import sys
import tempfile
from collections.abc import Callable, Sequence
from itertools import cycle
from pathlib import Path
from typing import NamedTuple, Protocol

import atheris

with atheris.instrument_imports(include=["mavstack.gnss", "mavstack.traffic"]):
    from mavstack.gnss.nmea import Fix, NmeaFramer, format_gga, format_rmc
    from mavstack.gnss.ntrip import CasterError, NtripClient, NtripURL
    from mavstack.gnss.rtcm import RtcmFrame, RtcmFramer
    from mavstack.gnss.ublox import UbxFramer
    from mavstack.traffic import AircraftTable, BeastReader, Gdl90Reader, SbsReader
    from mavstack.traffic.gdl90 import gdl90_frame

from tests.gnss.test_rtcm import msm, station
from tests.gnss.test_ublox import survey
from tests.traffic import test_beast, test_sbs
from tests.traffic.test_gdl90 import TRAFFIC

#: Sizes of the chunks of the second reader, one after the other.
CHUNKS = (1, 3, 7, 2, 64, 5)
FIX = Fix(1_795_867_200.0, 47.3977, 8.5456, 488.0, 6, 14, 0.6, 47.0)
CORRECTIONS = b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n5\r\nabcde\r\n"
TABLE = b"SOURCETABLE 200 OK\r\n\r\nSTR;NEAR;Town;RTCM 3;1005;2;GPS;X;CHE;47.39;8.54;1\r\nENDSOURCETABLE\r\n"


class Stream(NamedTuple):
    """A reader, the messages of its corpus, and the bytes that end what precedes a message."""

    reader: "Callable[[], Reader]"
    messages: list[bytes]
    separator: bytes


class Reader(Protocol):
    """A reader of a stream."""

    def feed(self, data: bytes) -> Sequence[object]:
        """Return what the bytes complete."""


class Caster:
    """The answer of a caster as a stream, which has its results at its end."""

    def __init__(self) -> None:
        self._client = NtripClient(NtripURL.parse("ntrip://caster/NEAR"))
        self._content = bytearray()
        self._failure = ""

    def feed(self, data: bytes) -> list[object]:
        """Let the client read bytes unless the caster has failed."""
        if not self._failure:
            try:
                self._content += self._client.feed(data)
            except CasterError as error:
                self._failure = str(error)
        return []

    def end(self) -> list[object]:
        """Return what the whole answer gave; the corrections only if it did not fail."""
        self._client.end()
        return [self._failure or bytes(self._content), self._client.source_table]


class TrackedAircraft:
    """The aircraft of a reader, which its table accepts with any values."""

    def __init__(self, reader: BeastReader | Gdl90Reader | SbsReader) -> None:
        self._reader, self._table = reader, AircraftTable()

    def feed(self, data: bytes) -> list[object]:
        """Return the aircraft after each report."""
        return [self._table.update(report, 0.0) for report in self._reader.feed(data)]


STREAMS = {
    "rtcm": Stream(RtcmFramer, [station().data, msm(1074, 5).data, RtcmFrame.of(b"").data], bytes(1100)),
    "nmea": Stream(NmeaFramer, [format_gga(FIX), format_rmc(FIX, 3.0, 90.0)], b"\r\n"),
    "ubx": Stream(UbxFramer, [survey(30, 21_000, 0)], bytes(8300)),
    "sbs": Stream(lambda: TrackedAircraft(SbsReader()), [test_sbs.POSITION, test_sbs.VELOCITY], b"\r\n"),
    "beast": Stream(
        lambda: TrackedAircraft(BeastReader()),
        [test_beast.beast(frame) for frame in (test_beast.NAME, test_beast.EVEN, test_beast.VELOCITY)],
        bytes(64),
    ),
    "gdl90": Stream(lambda: TrackedAircraft(Gdl90Reader()), [gdl90_frame(TRAFFIC)], b"\x7e"),
    "ntrip": Stream(Caster, [b"ICY 200 OK\r\n\r\nabc", b"ERROR - Bad Password\r\n", CORRECTIONS, TABLE], b""),
}


def feed_chunks(reader: Reader, data: bytes) -> list[object]:
    """Feed bytes in chunks of several sizes."""
    results: list[object] = []
    for size in cycle(CHUNKS):
        if not data:
            return results
        results += reader.feed(data[:size])
        data = data[size:]
    return results


def check(stream: Stream, data: bytes) -> None:
    """Feed bytes at once and in chunks, then a message; raise if a promise is broken."""
    whole, cut = stream.reader(), stream.reader()
    results = whole.feed(data)
    if feed_chunks(cut, data) != results:
        raise RuntimeError("the result depends on the chunks")
    if isinstance(whole, Caster):
        if whole.end() != cut.end():
            raise RuntimeError("the answer depends on the chunks")
        return
    whole.feed(stream.separator)
    for message in stream.messages:
        if len(whole.feed(message)) < len(stream.reader().feed(message)):
            raise RuntimeError("bytes before a message hide it")


if __name__ == "__main__":
    stream = STREAMS[sys.argv.pop(1)]
    corpus = Path(tempfile.mkdtemp())
    for number, message in enumerate(stream.messages):
        (corpus / str(number)).write_bytes(message)
        (corpus / f"{number} twice").write_bytes(message + b"\0" + message)
    atheris.Setup([*sys.argv, str(corpus)], lambda data: check(stream, data))
    atheris.Fuzz()
