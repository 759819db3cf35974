"""Captures for tests of the dissector, and the packets that tshark finds in them."""

from __future__ import annotations

import struct
import subprocess
from dataclasses import dataclass, field
from typing import TYPE_CHECKING
from xml.etree import ElementTree

from mavstack.codegen import generate, make_library, write_files
from mavstack.dialects import Dialect
from tests.codegen.compilers import needs

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

#: Link types of captures: IP packets, and the bytes of a serial port.
RAW_IP, USER0 = 101, 147
RIGHT, WRONG, UNKNOWN = "1", "0", "2"
ADDRESSES = bytes([127, 0, 0, 1, 127, 0, 0, 1])


@dataclass
class Dissected:
    """A packet as tshark shows it.

    Attributes:
        frame: Number of the frame, from 1.
        values: The shown values of each field, by the name of its filter.
        raw: The bytes of each field.
    """

    frame: int
    values: dict[str, list[str]] = field(default_factory=dict)
    raw: dict[str, list[bytes]] = field(default_factory=dict)

    def one(self, name: str) -> str:
        (value,) = self.values[f"mavlink.{name}"]
        return value

    @property
    def message(self) -> str:
        return self.one("message")


def generate_dissector(folder: Path, dialect: str | Dialect = "common") -> Path:
    """Write the dissector of a dialect; return its path."""
    loaded = Dialect.load(dialect) if isinstance(dialect, str) else dialect
    write_files(generate(make_library(loaded), "wireshark"), folder)
    (script,) = folder.glob("mavlink_*.lua")
    return script


def udp(data: bytes, source: int = 14550, target: int = 14550) -> bytes:
    """Return an IP packet with a datagram."""
    return _ip(17, struct.pack(">HHHH", source, target, 8 + len(data), 0) + data)


def tcp(data: bytes, sequence: int, source: int = 40000, target: int = 5760) -> bytes:
    """Return an IP packet with a segment."""
    header = struct.pack(">HHIIBBHHH", source, target, sequence, 1, 0x50, 0x18, 65535, 0, 0)
    return _ip(6, header + data)


def _ip(protocol: int, data: bytes) -> bytes:
    return struct.pack(">BBHHHBBH", 0x45, 0, 20 + len(data), 0, 0, 64, protocol, 0) + ADDRESSES + data


def capture(path: Path, frames: Iterable[bytes], link_type: int = RAW_IP) -> Path:
    """Write a capture with a frame each millisecond."""
    parts = [struct.pack("<IHHiIII", 0xA1B2C3D4, 2, 4, 0, 0, 262144, link_type)]
    for number, frame in enumerate(frames):
        seconds, milliseconds = divmod(number, 1000)
        head = struct.pack("<IIII", 1_700_000_000 + seconds, milliseconds * 1000, len(frame), len(frame))
        parts += [head, frame]
    path.write_bytes(b"".join(parts))
    return path


def tshark(dissector: Path, path: Path, *words: str) -> str:
    """Return the output of tshark, which reads a capture in two passes."""
    command = [needs("tshark"), "-X", f"lua_script:{dissector}", "-r", str(path), "-2", *words]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=110)
    assert done.returncode == 0, done.stderr
    assert "Lua" not in done.stderr, done.stderr
    assert "Lua Error" not in done.stdout, done.stdout[done.stdout.index("Lua Error") :][:500]
    return done.stdout


def dissect(dissector: Path, path: Path, *words: str) -> list[Dissected]:
    """Return the packets that tshark finds in a capture."""
    document = ElementTree.fromstring(tshark(dissector, path, "-T", "pdml", *words))
    packets = []
    for number, frame in enumerate(document.iter("packet"), 1):
        for proto in frame.iterfind("proto[@name='mavlink']"):
            found = Dissected(number)
            for item in proto.iter("field"):
                found.values.setdefault(item.get("name", ""), []).append(item.get("show", ""))
                found.raw.setdefault(item.get("name", ""), []).append(_bytes(item))
            if "mavlink.message" in found.values:
                packets.append(found)
    return packets


def _bytes(item: ElementTree.Element) -> bytes:
    """Return the bytes of a field; those of a flag are a number instead."""
    value = "" if item.get("unmaskedvalue") else item.get("value", "")
    return bytes.fromhex(value) if len(value) % 2 == 0 else b""
