"""A stream of MCAP, to which the messages of a channel are added many at a time.

The writer of the format's authors adds them one by one, in Python. Here the records of a chunk and its index
are made by Arrow and numpy; the other records are those of the library `mcap`.
"""

from __future__ import annotations

import zlib
from collections import Counter
from importlib import import_module
from typing import IO, TYPE_CHECKING, Any, Final

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from numpy.typing import NDArray

_MAGIC: Final = b"\x89MCAP0\r\n"
#: Size of a chunk in bytes before compression; a reader decompresses whole chunks.
_CHUNK: Final = 1 << 20
_MESSAGE: Final = 0x05
_MESSAGE_INDEX: Final = 0x07
#: The beginning of a message record; `length` counts the bytes after itself.
_HEADER: Final = np.dtype(
    [
        ("opcode", "u1"),
        ("length", "<u8"),
        ("channel", "<u2"),
        ("sequence", "<u4"),
        ("log_time", "<u8"),
        ("publish_time", "<u8"),
    ]
)
_UNCOUNTED: Final = 9
_INDEX_ENTRY: Final = np.dtype([("time", "<u8"), ("offset", "<u8")])


class McapStream:
    """The open stream.

    Args:
        stream: A file, open for writing at its beginning.

    Raises:
        ImportError: The library `mcap`, or one that it needs, is not installed.
    """

    def __init__(self, stream: IO[bytes]) -> None:
        self._stream = stream
        self._records = import_module("mcap.records")
        self._builder = import_module("mcap.data_stream").RecordBuilder
        self._compress: Callable[[bytes], bytes] = import_module("zstandard").compress
        self._schemas: list[Any] = []
        self._channels: list[Any] = []
        self._chunks: list[Any] = []
        self._metadata: list[Any] = []
        self._messages: Counter[int] = Counter()
        self._pending: list[tuple[int, NDArray[np.void], bytes]] = []
        self._pending_size = 0
        stream.write(_MAGIC)
        self._write(self._records.Header(profile="", library="mavstack"))

    def add_schema(self, name: str, data: bytes) -> int:
        """Add a JSON schema, and return its number."""
        number = len(self._schemas) + 1
        self._schemas.append(self._records.Schema(id=number, data=data, encoding="jsonschema", name=name))
        self._write(self._schemas[-1])
        return number

    def add_channel(self, topic: str, schema: int) -> int:
        """Add a channel of JSON messages, and return its number."""
        number = len(self._channels) + 1
        channel = self._records.Channel(
            id=number, topic=topic, message_encoding="json", schema_id=schema, metadata={}
        )
        self._channels.append(channel)
        self._write(channel)
        return number

    def add_messages(self, channel: int, times: NDArray[np.uint64], contents: Any) -> None:  # noqa: ANN401
        """Add messages to a channel.

        Args:
            channel: Number of the channel.
            times: Times in nanoseconds.
            contents: A pyarrow array of strings, one for each time.
        """
        for index, data in _records(channel, times, contents):
            self._pending.append((channel, index, data))
            self._pending_size += len(data)
            if self._pending_size >= _CHUNK:
                self._write_chunk()
        self._messages[channel] += len(times)

    def add_metadata(self, name: str, values: dict[str, str]) -> None:
        """Add a record of texts."""
        start, length = self._write(self._records.Metadata(name=name, metadata=values))
        self._metadata.append(self._records.MetadataIndex(offset=start, length=length, name=name))

    def finish(self) -> None:
        """Write what follows the messages; the file stays open."""
        self._write_chunk()
        self._write(self._records.DataEnd(0))
        start, summary = self._stream.tell(), self._builder()
        groups = (self._schemas, self._channels, [self._statistics()], self._chunks, self._metadata)
        offsets = [self._add_group(summary, start, group) for group in groups if group]
        offsets_start = start + summary.count
        for offset in offsets:
            offset.write(summary)
        data = bytes(summary.end())
        footer = self._built(self._records.Footer(start, offsets_start, 0))
        crc = zlib.crc32(footer[:-4], zlib.crc32(data))
        self._stream.write(data + footer[:-4] + crc.to_bytes(4, "little") + _MAGIC)

    def _add_group(self, summary: Any, start: int, group: list[Any]) -> Any:  # noqa: ANN401 (mcap's classes)
        """Add records of one kind to the summary, and return the record with their position."""
        begin = summary.count
        for record in group:
            record.write(summary)
        opcode = self._built(group[0])[0]
        return self._records.SummaryOffset(opcode, start + begin, summary.count - begin)

    def _statistics(self) -> Any:  # noqa: ANN401 (mcap's class)
        return self._records.Statistics(
            attachment_count=0,
            channel_count=len(self._channels),
            channel_message_counts=dict(self._messages),
            chunk_count=len(self._chunks),
            message_count=self._messages.total(),
            message_end_time=max((chunk.message_end_time for chunk in self._chunks), default=0),
            message_start_time=min((chunk.message_start_time for chunk in self._chunks), default=0),
            metadata_count=len(self._metadata),
            schema_count=len(self._schemas),
        )

    def _write_chunk(self) -> None:
        pending, self._pending, self._pending_size = self._pending, [], 0
        if not pending:
            return
        data, times = b"".join(block for *_, block in pending), [index["time"] for _, index, _ in pending]
        compressed = self._compress(data)
        first, last = min(int(each.min()) for each in times), max(int(each.max()) for each in times)
        common = {"compression": "zstd", "message_start_time": first, "message_end_time": last}
        chunk = self._records.Chunk(
            data=compressed, uncompressed_crc=zlib.crc32(data), uncompressed_size=len(data), **common
        )
        start, length = self._write(chunk)
        index_start, offsets = self._stream.tell(), self._write_indexes(pending)
        self._chunks.append(
            self._records.ChunkIndex(
                chunk_start_offset=start,
                chunk_length=length,
                compressed_size=len(compressed),
                uncompressed_size=len(data),
                message_index_offsets=offsets,
                message_index_length=self._stream.tell() - index_start,
                **common,
            )
        )

    def _write_indexes(self, pending: list[tuple[int, NDArray[np.void], bytes]]) -> dict[int, int]:
        """Write where the messages of each channel are in the chunk; return where that is in the file."""
        by_channel: dict[int, list[NDArray[np.void]]] = {}
        base = 0
        for channel, index, data in pending:
            index["offset"] += np.uint64(base)
            by_channel.setdefault(channel, []).append(index)
            base += len(data)
        offsets = {}
        for channel, indexes in by_channel.items():
            offsets[channel] = self._stream.tell()
            entries = b"".join(index.tobytes() for index in indexes)
            content = channel.to_bytes(2, "little") + len(entries).to_bytes(4, "little") + entries
            self._stream.write(bytes([_MESSAGE_INDEX]) + len(content).to_bytes(8, "little") + content)
        return offsets

    def _write(self, record: Any) -> tuple[int, int]:  # noqa: ANN401 (mcap's classes)
        """Write a record; return its position and its length."""
        start, data = self._stream.tell(), self._built(record)
        self._stream.write(data)
        return start, len(data)

    def _built(self, record: Any) -> bytes:  # noqa: ANN401 (mcap's classes)
        builder = self._builder()
        record.write(builder)
        return bytes(builder.end())


def _records(
    channel: int,
    times: NDArray[np.uint64],
    contents: Any,  # noqa: ANN401 (pyarrow has no types)
) -> Iterator[tuple[NDArray[np.void], bytes]]:
    """Yield the records of messages, of about a chunk each, with the time and the offset of each record."""
    size = max(contents.nbytes // max(len(times), 1), 1) + _HEADER.itemsize
    step = max(_CHUNK // size, 1)
    for first in range(0, len(times), step):
        yield _joined_records(channel, times[first : first + step], contents[first : first + step])


def _joined_records(
    channel: int,
    times: NDArray[np.uint64],
    contents: Any,  # noqa: ANN401
) -> tuple[NDArray[np.void], bytes]:
    arrow, compute = import_module("pyarrow"), import_module("pyarrow.compute")
    headers = np.zeros(len(times), _HEADER)
    headers["opcode"], headers["channel"] = _MESSAGE, channel
    headers["length"] = compute.binary_length(contents).to_numpy() + (_HEADER.itemsize - _UNCOUNTED)
    headers["log_time"] = headers["publish_time"] = times
    ends = np.arange(0, headers.nbytes + 1, _HEADER.itemsize, dtype=np.int32)
    beginnings = arrow.Array.from_buffers(
        arrow.binary(), len(times), [None, arrow.py_buffer(ends), arrow.py_buffer(headers)]
    )
    records = compute.binary_join_element_wise(beginnings, contents.cast(arrow.binary()), b"")
    index = np.empty(len(times), _INDEX_ENTRY)
    starts = np.frombuffer(records.buffers()[1], np.int32)
    index["time"], index["offset"] = times, starts[: len(times)]
    return index, records.buffers()[2][: starts[len(times)]].to_pybytes()
