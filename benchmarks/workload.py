"""A synthetic flight: any number of valid packets from a fixed seed, generated in a few seconds.

Neither Mavstack nor a peer encodes the packets: numpy fills the payloads of a message as rows of one
structured array, trims trailing zeros, numbers the packets and computes the checksums column by column. Only
the layouts (order of fields, CRC_EXTRA) are taken from pymavlink, and every reader must count exactly the
generated packets. Each source (system, component) counts its own sequence numbers; the messages are
interleaved by the times given by their rates.
"""

from __future__ import annotations

import hashlib
import importlib
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from .mix import PROFILES, MessageProfile, Value

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path
    from types import ModuleType

Bytes2D: TypeAlias = NDArray[np.uint8]

SEED = 20150101
START_UNIX_US = 1_750_000_000_000_000
SIGNING_EPOCH_UNIX = 1_420_070_400
SIGNING_KEY = hashlib.sha256(b"a key for measurements only").digest()
SIGNING_START = (START_UNIX_US // 1_000_000 - SIGNING_EPOCH_UNIX) * 100_000
HEADER = 10
STAMP = 8
NUMPY_TYPES = {"c": "S", "B": "u1", "b": "i1", "H": "<u2", "h": "<i2", "I": "<u4", "i": "<i4"}
NUMPY_TYPES |= {"Q": "<u8", "q": "<i8", "f": "<f4", "d": "<f8"}


@dataclass(frozen=True)
class Workload:
    """The packets of a log in one buffer, and their positions."""

    stream: bytes
    starts: NDArray[np.int64]
    times_us: NDArray[np.int64]

    def __len__(self) -> int:
        return len(self.starts)

    @property
    def mean_size(self) -> float:
        """Mean packet length in bytes, including header and checksum."""
        return len(self.stream) / len(self.starts)

    @cached_property
    def ends(self) -> NDArray[np.int64]:
        """End positions of the packets."""
        return np.append(self.starts[1:], len(self.stream))

    def packets(self, count: int) -> list[bytes]:
        """Return the first packets as separate objects."""
        return [self.stream[a:b] for a, b in zip(self.starts[:count], self.ends[:count], strict=True)]

    def chunks(self, size: int, count: int) -> list[bytes]:
        """Return the first packets as chunks of `size` bytes, cut at any position."""
        end = int(self.ends[count - 1])
        return [self.stream[at : min(at + size, end)] for at in range(0, end, size)]

    def tlog(self, count: int) -> bytes:
        """Return the first packets as a tlog: with a big-endian timestamp of 8 bytes before each."""
        records, is_stamp = self._records(count)
        records[is_stamp] = self.times_us[:count].astype(">i8").view(np.uint8)
        return records.tobytes()

    def write_tlog(self, path: Path, size: int) -> int:
        """Write a tlog of at least `size` bytes: the flight, repeated with advancing times.

        Args:
            path: Path of the file.
            size: Bytes.

        Returns:
            Number of packets in the file.
        """
        records, is_stamp = self._records(len(self))
        turns = -(-size // len(records))
        length = int(self.times_us[-1] - self.times_us[0]) + 1
        with path.open("wb") as file:
            for turn in range(turns):
                records[is_stamp] = (self.times_us + turn * length).astype(">i8").view(np.uint8)
                records.tofile(file)
        return turns * len(self)

    def _records(self, count: int) -> tuple[NDArray[np.uint8], NDArray[np.bool_]]:
        """Return the records of the first packets, and where their timestamps are, which are not set."""
        end = int(self.ends[count - 1])
        is_stamp = np.zeros(end + STAMP * count, np.bool_)
        positions = self.starts[:count] + STAMP * np.arange(count)
        is_stamp[(positions[:, None] + np.arange(STAMP)).ravel()] = True
        records = np.empty(len(is_stamp), np.uint8)
        records[~is_stamp] = np.frombuffer(self.stream, np.uint8, end)
        return records, is_stamp

    def signed(self, count: int) -> list[bytes]:
        """Return the first packets, signed with `SIGNING_KEY` on link 0 with increasing timestamps."""
        return list(_signed(self.packets(count)))


def build(count: int) -> Workload:
    """Generate a flight of `count` packets."""
    random = np.random.default_rng(SEED)
    due, kinds = _schedule(count)
    sequences = _sequences(kinds)
    lengths = np.empty(count, np.int64)
    rows: list[tuple[NDArray[np.int64], Bytes2D]] = []
    for kind, profile in enumerate(PROFILES):
        at = np.flatnonzero(kinds == kind)
        packets, sizes = _packets(profile, due[at], sequences[at], random)
        lengths[at] = sizes
        rows.append((at, packets))
    starts = np.cumsum(lengths) - lengths
    out = np.empty(int(lengths.sum()), np.uint8)
    for at, packets in rows:
        sizes = lengths[at]
        for size in np.unique(sizes):
            chosen = np.flatnonzero(sizes == size)
            out[starts[at[chosen]][:, None] + np.arange(size)] = packets[chosen, :size]
    return Workload(out.tobytes(), starts, START_UNIX_US + due)


def dialect_module() -> ModuleType:
    """Return the dialect module of pymavlink."""
    return importlib.import_module("pymavlink.dialects.v20.ardupilotmega")


def layout(name: str) -> type[Any]:
    """Return the class of a message in pymavlink."""
    found: type[Any] = getattr(dialect_module(), f"MAVLink_{name.lower()}_message")
    return found


def _schedule(count: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    seconds = count / sum(profile.hertz for profile in PROFILES) * 1.01 + 10
    due, kinds = [], []
    for kind, profile in enumerate(PROFILES):
        moments = (np.arange(int(seconds * profile.hertz) + 1) + kind / len(PROFILES)) / profile.hertz
        due.append((moments * 1e6).astype(np.int64))
        kinds.append(np.full(len(moments), kind))
    times, kinds_of_times = np.concatenate(due), np.concatenate(kinds)
    order = np.argsort(times, kind="stable")[:count]
    return times[order], kinds_of_times[order]


def _sequences(kinds: NDArray[np.int64]) -> NDArray[np.uint8]:
    source_of_kind = np.array([profile.system << 8 | profile.component for profile in PROFILES])
    sources = source_of_kind[kinds]
    sequences = np.empty(len(kinds), np.uint8)
    for source in np.unique(sources):
        positions = np.flatnonzero(sources == source)
        sequences[positions] = np.arange(len(positions)) % 256
    return sequences


def _packets(
    profile: MessageProfile, due: NDArray[np.int64], sequences: NDArray[np.uint8], random: np.random.Generator
) -> tuple[Bytes2D, NDArray[np.int64]]:
    message = layout(profile.name)
    payload = _payloads(message, profile, due, random)
    lengths = _trimmed(payload)
    count, full = payload.shape
    packets = np.zeros((count, HEADER + full + 2), np.uint8)
    packets[:, 0] = 0xFD
    packets[:, 1] = lengths
    packets[:, 4] = sequences
    packets[:, 5:7] = profile.system, profile.component
    packets[:, 7:10] = message.id & 255, message.id >> 8 & 255, message.id >> 16
    packets[:, HEADER:-2] = payload
    checksum = _checksums(packets, HEADER + lengths, message.crc_extra)
    each = np.arange(count)
    packets[each, HEADER + lengths] = checksum & 255
    packets[each, HEADER + lengths + 1] = checksum >> 8
    return packets, HEADER + lengths + 2


def _payloads(
    message: type[Any], profile: MessageProfile, due: NDArray[np.int64], random: np.random.Generator
) -> Bytes2D:
    dtype = _dtype(message)
    missing = (set(profile.values) | set(profile.read_fields)) - set(dtype.names or ())
    if missing:
        raise LookupError(f"{profile.name} has no {', '.join(sorted(missing))}")
    rows = np.zeros(len(due), dtype)
    for name, value in profile.values.items():
        rows[name] = _column(value, rows[name], due, random)
    return rows.view(np.uint8).reshape(len(due), dtype.itemsize)


def _dtype(message: type[Any]) -> np.dtype[Any]:
    fields: list[tuple[Any, ...]] = []
    codes = message.native_format.decode().lstrip("<")
    for name, code, length in zip(message.ordered_fieldnames, codes, message.array_lengths, strict=True):
        kind = NUMPY_TYPES[code]
        if code == "c":
            fields.append((name, f"S{length}"))
        else:
            fields.append((name, kind, (length,)) if length else (name, kind))
    return np.dtype(fields)


def _column(
    value: Value, like: NDArray[Any], due: NDArray[np.int64], random: np.random.Generator
) -> NDArray[Any] | float:
    clocks = {"ms": due // 1000, "us": due, "unix": START_UNIX_US + due}
    match value:
        case str():
            return clocks[value]
        case int() | float():
            return value
        case list():
            return random.choice(np.array(value, like.dtype), like.shape)
        case low, high:
            return random.uniform(low, high, like.shape).astype(like.dtype)


def _trimmed(payload: Bytes2D) -> NDArray[np.int64]:
    positions = np.arange(1, payload.shape[1] + 1)
    last: NDArray[np.int64] = ((payload != 0) * positions).max(axis=1)
    return np.maximum(last, 1)


def _checksums(packets: Bytes2D, ends: NDArray[np.int64], extra: int) -> NDArray[np.uint16]:
    """Calculate the CRC-16/MCRF4XX of all rows: bytes 1 to the end, then CRC_EXTRA."""
    table = np.array(_TABLE, np.uint16)
    crc = np.full(len(packets), 0xFFFF, np.uint16)
    for position in range(1, int(ends.max())):
        stepped = table[(crc ^ packets[:, position]) & 0xFF] ^ (crc >> 8)
        crc = np.where(position < ends, stepped, crc)
    last: NDArray[np.uint16] = table[(crc ^ extra) & 0xFF] ^ (crc >> 8)
    return last


def _table_entry(index: int) -> int:
    for _ in range(8):
        index = index >> 1 ^ (0x8408 if index & 1 else 0)
    return index


_TABLE = tuple(_table_entry(index) for index in range(256))


def _signed(packets: list[bytes]) -> Iterator[bytes]:
    by_id = dialect_module().mavlink_map
    for number, packet in enumerate(packets):
        flagged = packet[:2] + b"\x01" + packet[3:-2]
        extra = by_id[int.from_bytes(packet[7:10], "little")].crc_extra
        crc = _checksum(flagged[1:] + bytes((extra,)))
        body = flagged + crc.to_bytes(2, "little") + b"\x00" + (SIGNING_START + number).to_bytes(6, "little")
        yield body + hashlib.sha256(SIGNING_KEY + body).digest()[:6]


def _checksum(data: bytes) -> int:
    crc = 0xFFFF
    for byte in data:
        crc = _TABLE[(crc ^ byte) & 0xFF] ^ (crc >> 8)
    return crc
