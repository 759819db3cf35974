"""Fuzz target of the capture reader: any bytes are a log, and every byte of the file is a frame or counted.

Run by `rust/fuzz/run`; needs `pip install atheris`.
"""

import sys
import tempfile
from pathlib import Path

import atheris

with atheris.instrument_imports(include=["mavstack.logs.packets.pcap"]):
    from mavstack.dialects import Dialect
    from mavstack.logs.packets.pcap import CaptureLog

from tests.logs.packets.pcap.captures import ethernet, pcap, pcapng, tcp, udp

FOLDER = Path(tempfile.mkdtemp())
DIALECT = Dialect.load("common")
HEARTBEAT = bytes.fromhex("fd0900000001010000000000000002030000032bb4")


def load(data: bytes) -> None:
    """Open one file, and decode all its tables."""
    path = FOLDER / "fuzz.pcap"
    path.write_bytes(data)
    log = CaptureLog(path, DIALECT)
    assert {name: len(table) for name, table in log.items()} == log.counts
    assert log.skipped.bad_bytes <= 2 * len(data)


if __name__ == "__main__":
    corpus = Path(tempfile.mkdtemp())
    (corpus / "pcap").write_bytes(pcap([udp(HEARTBEAT), tcp(HEARTBEAT, 0)]))
    (corpus / "pcapng").write_bytes(pcapng([ethernet(udp(HEARTBEAT), 0x8100)], 1))
    atheris.Setup([*sys.argv, str(corpus)], load)
    atheris.Fuzz()
