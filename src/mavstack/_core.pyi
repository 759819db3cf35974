"""The compiled core: parsing, encoding, signing, and the fields of messages."""

from collections.abc import Callable, Iterable, Sequence
from typing import Any, Protocol, Self, TypeAlias, dataclass_transform, final

from typing_extensions import Buffer

# (name, type, array length or 0, offset in the full payload, true if it reads as an enum)
FieldLayout: TypeAlias = tuple[str, str, int, int, bool]
# (id, name, CRC_EXTRA, payload length without extensions, payload length with them, fields in definition order)
MessageLayout: TypeAlias = tuple[int, str, int, int, int, Sequence[FieldLayout]]

class HasCoreDialect(Protocol):
    """A `mavstack.Dialect` or a dialect module such as `mavstack.dialects.common`."""

    @property
    def core_dialect(self) -> Dialect:
        """The layout tables of the dialect."""

#: The compiler that built the core, and whose it is: "rustc 1.95.0 (59807616e 2026-04-14) of the system".
TOOLCHAIN: str

def avoiding_velocities(
    positions: Buffer,
    velocities: Buffer,
    preferred: Buffer,
    *,
    distance: float,
    horizon: float,
    speed: float,
    neighbours: int,
    separation_time: float,
) -> bytes: ...
def crc16(data: Buffer, crc: int = 0xFFFF) -> int:
    """Calculate the CRC-16/MCRF4XX of `data`, the checksum of MAVLink packets.

    Args:
        data: The bytes to add to the checksum.
        crc: The checksum to continue from; by default the initial value 0xFFFF.

    Returns:
        The checksum, 0 to 0xFFFF.
    """

@final
class Dialect:
    """The layout tables of one dialect.

    Args:
        name: Name of the dialect.
        messages: Layouts of all messages.
        make_class: Called with a message id when the class of the message is first needed; returns the class.

    Raises:
        DialectError: A layout contradicts itself, or two messages have the same id.
    """

    def __new__(
        cls, name: str, messages: Iterable[MessageLayout], make_class: Callable[[int], type[MessageBase]]
    ) -> Self: ...
    @property
    def name(self) -> str:
        """Name of the dialect."""

    @property
    def core_dialect(self) -> Dialect:
        """The dialect itself, so that a core dialect is accepted where a dialect is expected."""

    def __len__(self) -> int: ...
    def __contains__(self, message_id: int) -> bool: ...

def new_message_class(
    name: str,
    bases: tuple[type, ...],
    namespace: dict[str, Any],
    layout: MessageLayout,
    template: Buffer | None = None,
    members: Sequence[tuple[str, bool]] | None = None,
) -> type[MessageBase]:
    """Create a message class whose fields read and write the payload bytes.

    The class must have the class method `_enum_values(field_name)`, which returns `(members by value, fallback or
    None)` and is called once per enum field, on first read; `fallback(int)` is called for values without a member.

    Args:
        name: The class name.
        bases: The base classes; one of them derives from `MessageBase`.
        namespace: The class attributes.
        layout: The layout of the message.
        template: The payload of a message created without arguments, padded with zeros; all zeros if None.
        members: The name of each field in JSON, and whether its value is hidden there; None: the names of the
            layout, nothing hidden.

    Returns:
        The new class.

    Raises:
        DialectError: The layout contradicts itself.
        TypeError: A base has a dictionary or weak references, or none derives from `MessageBase`.
        ValueError: There is not one member for each field.
    """

def fields_json(source: Packet | MessageBase, *, strict: bool = False, ascii: bool = True) -> str | None:
    """Return the fields of a packet or of a message as a JSON object, written from its bytes.

    Enum values are integers, byte arrays are arrays of numbers, secret values are "(hidden)".

    Args:
        source: The packet or the message.
        strict: No spaces, null for numbers that are not finite, and floats as Python shows them. Otherwise a
            space after commas and colons, the strings "NaN", "Infinity" and "-Infinity", and float32 values with
            the fewest digits that read back to the same float32.
        ascii: Escape the characters outside ASCII.

    Returns:
        The JSON text; None for a packet whose message is not in its dialect.

    Raises:
        TypeError: The object is neither a packet nor a message.
    """

@dataclass_transform(eq_default=False)
class MessageMeta(type):
    """Metaclass of the message classes."""

class MessageBase(metaclass=MessageMeta):
    """Base of the message classes: a typed view over a payload.

    Fields are given as positional or keyword arguments; fields not given are zero.

    Raises:
        FieldNameError: The message has no field of that name, or fewer fields than arguments.
        FieldTypeError: A value has a wrong type.
        FieldRangeError: A value is outside the range of its field.
    """

    def __new__(cls, *args: Any, **fields: Any) -> Self: ...
    def to_payload(self, version: int = 2, /) -> bytes:
        """Return the payload as sent on the wire.

        Args:
            version: MAVLink version: 2 trims trailing zero bytes, 1 leaves the extension fields out.

        Returns:
            The payload bytes.

        Raises:
            ValueError: The version is neither 1 nor 2.
        """

    @classmethod
    def from_payload(cls, payload: Buffer, /) -> Self:
        """Create a message from its payload.

        Args:
            payload: The payload bytes: missing bytes are zero, bytes beyond the known fields are ignored.

        Returns:
            A message of this class.
        """

@final
class Statistics:
    """Totals of one byte stream."""

    @property
    def packets(self) -> int:
        """Number of packets."""

    @property
    def packet_bytes(self) -> int:
        """Total length of the packets in bytes."""

    @property
    def version_1(self) -> int:
        """Number of MAVLink 1 packets."""

    @property
    def version_2(self) -> int:
        """Number of MAVLink 2 packets."""

    @property
    def signed(self) -> int:
        """Number of packets with a signature, valid or not."""

    @property
    def unknown(self) -> int:
        """Number of packets whose message id is not in the dialect."""

    @property
    def bad_bytes(self) -> int:
        """Number of bytes outside any packet."""

    @property
    def bad_checksum(self) -> int:
        """Number of false magics and damaged packets, rejected by their checksum."""

    @property
    def bad_flags(self) -> int:
        """Number of false magics and packets rejected for an unknown incompatibility flag."""

    @property
    def bad_length(self) -> int:
        """Number of MAVLink 1 packets shorter than their message."""

@final
class SourceStatistics:
    """Statistics of one source: the packets of one system and component on one link."""

    @property
    def received(self) -> int:
        """Number of packets received."""

    @property
    def bytes(self) -> int:
        """Total length of the packets in bytes."""

    @property
    def lost(self) -> int:
        """Number of packets lost, from gaps in the sequence numbers."""

    @property
    def late(self) -> int:
        """Number of late or duplicate packets."""

    @property
    def loss(self) -> float:
        """Fraction of the sent packets that were lost, 0 to 1."""

@final
class Refusals:
    """Number of packets refused by signing, by reason."""

    @property
    def unsigned(self) -> int:
        """Unsigned packets whose message id is not accepted unsigned."""

    @property
    def forged(self) -> int:
        """Packets whose hash does not match the key."""

    @property
    def replayed(self) -> int:
        """Packets whose timestamp is not newer than the last of their stream."""

    @property
    def stale(self) -> int:
        """First packets of a stream that are too far behind the clock."""

    @property
    def future(self) -> int:
        """Packets too far ahead of the clock."""

    @property
    def too_many_streams(self) -> int:
        """First packets of a stream beyond the maximum number of streams."""

    @property
    def total(self) -> int:
        """Total number of refused packets."""

@final
class Signing:
    """Signing state of one link: signs sent packets and verifies received ones.

    The parser and the encoder of the link share one object. Refused packets are counted in `refusals`. All links of
    one key must share their clock and their streams (`for_link`), or a packet accepted on one link can be replayed on
    another.

    Args:
        key: The 32 bytes of the key.
        link_id: Id of the link in signatures, 0 to 255.
        timestamp: Initial clock in 10 us since 2015-01-01 UTC: the `timestamp` stored by the last run, or 0.
        accept_unsigned: Accept all unsigned packets.
        unsigned_ids: Message ids accepted unsigned, such as that of RADIO_STATUS.
        max_behind: Maximum age in seconds of the first packet of a stream.
        max_ahead: Maximum lead in seconds of a packet over the clock.
        reorder_slack: Maximum lag in seconds of a reordered packet behind the newest of its stream; 0 refuses all.
        max_streams: Maximum number of streams (link id, system, component); a full table forgets streams whose packets
            would be refused by `max_behind`.

    Raises:
        SigningError: The key does not have 32 bytes, or the timestamp does not fit 48 bits.
    """

    def __new__(
        cls,
        key: Buffer,
        link_id: int = 0,
        *,
        timestamp: int = 0,
        accept_unsigned: bool = False,
        unsigned_ids: Sequence[int] = (),
        max_behind: float = 60.0,
        max_ahead: float = 86400.0,
        reorder_slack: float = 0.0,
        max_streams: int = 1024,
    ) -> Self: ...
    @property
    def link_id(self) -> int:
        """Id of the link in signatures."""

    @property
    def timestamp(self) -> int:
        """Newest timestamp sent or accepted, in 10 us since 2015-01-01 UTC: store it for the next run."""

    @property
    def streams(self) -> int:
        """Number of known streams (link id, system, component) of all links."""

    @property
    def stream_timestamps(self) -> dict[tuple[int, int, int], int]:
        """Newest timestamp of each stream (link id, system, component): store them for the next run."""

    def for_link(self, link_id: int) -> Signing:
        """Create the signing state of another link of the same key, with the same policy, clock and streams.

        Args:
            link_id: Id of the other link in signatures, 0 to 255.

        Returns:
            The signing state of the other link; a packet accepted by one of them is a replay for all others.
        """

    def advance(self, timestamp: int) -> None:
        """Advance the clock of all links of the key; an older timestamp has no effect.

        Args:
            timestamp: A trusted timestamp in 10 us since 2015-01-01 UTC, such as the one that came with the key.

        Raises:
            SigningError: The timestamp does not fit 48 bits.
        """

    def restore(self, stream_timestamps: dict[tuple[int, int, int], int], *, floor: int = 0) -> None:
        """Restore the streams of the last run, so that its packets are refused as replays.

        Args:
            stream_timestamps: Newest timestamp of each stream, as in the attribute of the last run.
            floor: Timestamp up to which packets of all streams are refused.

        Raises:
            SigningError: A timestamp does not fit 48 bits.
        """

    @property
    def refusals(self) -> Refusals:
        """Number of refused packets, by reason."""

@final
class Packet:
    """A received packet with its unchanged bytes.

    Args:
        raw: The bytes of exactly one packet.
        dialect: The dialect that decodes its message.
        timestamp: Recorded time in microseconds since 1970, or None.

    Raises:
        ValueError: The bytes are not exactly one valid packet.
    """

    def __new__(cls, raw: Buffer, dialect: HasCoreDialect, timestamp: int | None = None) -> Self: ...
    @property
    def message(self) -> Any:
        """The message, or None if its id is not in the dialect."""

    @property
    def name(self) -> str | None:
        """Name of the message, such as "ATTITUDE", or None if its id is not in the dialect."""

    @property
    def version(self) -> int:
        """MAVLink version, 1 or 2."""

    @property
    def message_id(self) -> int:
        """Message id, 0 to 16777215."""

    @property
    def system(self) -> int:
        """System id of the sender, 0 to 255."""

    @property
    def component(self) -> int:
        """Component id of the sender, 0 to 255."""

    @property
    def sequence(self) -> int:
        """Sequence number, 0 to 255."""

    @property
    def incompat_flags(self) -> int:
        """Incompatibility flags; 0 in MAVLink 1."""

    @property
    def compat_flags(self) -> int:
        """Compatibility flags; 0 in MAVLink 1."""

    @property
    def signed(self) -> bool:
        """True if the packet carries a signature; only a parser with signing verifies it."""

    @property
    def link_id(self) -> int | None:
        """Link id of the signature, or None if unsigned."""

    @property
    def signature_timestamp(self) -> int | None:
        """Timestamp of the signature in 10 us since 2015-01-01 UTC, or None if unsigned."""

    @property
    def signature(self) -> bytes | None:
        """The 13 bytes of the signature, or None if unsigned."""

    @property
    def timestamp(self) -> int | None:
        """Recorded time in microseconds since 1970, or None if the stream is not timestamped."""

    @property
    def checksum(self) -> int:
        """CRC of the packet as received."""

    @property
    def payload(self) -> bytes:
        """Payload as received: trimmed, complete, or longer than the definition."""

    @property
    def raw(self) -> bytes:
        """All bytes of the packet as received."""

    def __len__(self) -> int: ...

@final
class Parser:
    """Parser of one byte stream: takes bytes in chunks of any size and returns the packets in them.

    MAVLink 1 and 2 may be mixed. Bytes that are no valid packet never raise: they are counted in `statistics` and
    skipped. Packets whose message id is not in the dialect are returned too, with `message` None.

    Args:
        dialect: A `mavstack.Dialect` or a dialect module, which defines the messages.
        signing: Signing state of the link; packets that it refuses are not returned. None disables verification.
        timestamped: True for a tlog, which has 8 bytes of time before each packet.
    """

    def __new__(cls, dialect: HasCoreDialect, *, signing: Signing | None = None, timestamped: bool = False) -> Self: ...
    def feed(self, data: Buffer, now: float | None = None) -> list[Packet]:
        """Parse the next bytes of the stream.

        Args:
            data: The received bytes, in chunks of any size.
            now: Current Unix time in seconds, used for signing only. With None, the age of a stream's first packet is
                measured from the signing clock alone, and the maximum lead of a packet from the system's clock.

        Returns:
            The packets completed by `data`, in order.

        Raises:
            SigningError: `now` is not a valid time for signing.
        """

    def feed_records(
        self, data: Buffer, time: int, apart: Sequence[int], now: float | None = None
    ) -> list[tuple[bytes, int] | Packet]:
        """Parse the next bytes of the stream, and return its packets as records of a tlog: 8 bytes of time, then the
        packet.

        Args:
            data: The received bytes, in chunks of any size.
            time: The time of the records, in microseconds since 1970.
            apart: Message ids whose packets are returned as packets, as signed ones are, to be changed before they
                are recorded.
            now: Current Unix time in seconds, as in `feed`.

        Returns:
            The parts in order, each the bytes of records and their number, or one packet.

        Raises:
            SigningError: `now` is not a valid time for signing.
        """

    def flush(self, now: float | None = None) -> list[Packet]:
        """End the stream, and parse the rest of it.

        Args:
            now: Current Unix time in seconds, as in `feed`.

        Returns:
            The packets inside an apparent incomplete packet at the end of the stream.

        Raises:
            SigningError: `now` is not a valid time for signing.
        """

    @property
    def dialect(self) -> Dialect:
        """The layout tables of the dialect."""

    @property
    def signing(self) -> Signing | None:
        """Signing state of the link, or None."""

    @property
    def statistics(self) -> Statistics:
        """Totals of the stream so far."""

    @property
    def sources(self) -> dict[tuple[int, int], SourceStatistics]:
        """Statistics of each source, by (system, component); of 1,024 sources, those with many packets are kept longest."""

    @property
    def pending(self) -> int:
        """Number of bytes kept until more arrive."""

def encode(
    message: MessageBase,
    *,
    system: int,
    component: int,
    sequence: int = 0,
    version: int = 2,
    signing: Signing | None = None,
    now: float | None = None,
) -> bytes:
    """Encode one message as a packet.

    Args:
        message: The message to encode.
        system: System id of the sender, 0 to 255.
        component: Component id of the sender, 0 to 255.
        sequence: Sequence number of the packet, 0 to 255.
        version: MAVLink version, 1 or 2.
        signing: Signing state of the link, which signs the packet; None for an unsigned packet.
        now: Current Unix time in seconds, used for signing only; None advances the signing timestamp by one unit.

    Returns:
        The bytes of the packet.

    Raises:
        EncodeError: An id is out of range, or the version cannot carry the message or the signature.
        SigningError: `now` is not a valid time for signing.
    """

@final
class Encoder:
    """Encoder of the messages that one component sends over one link, with their sequence numbers.

    Args:
        system: System id of the sender, 0 to 255.
        component: Component id of the sender, 0 to 255.
        version: MAVLink version, 1 or 2.
        signing: Signing state of the link, which signs the packets; None for unsigned packets.

    Raises:
        EncodeError: An id or the version is out of range.
    """

    def __new__(cls, system: int, component: int, *, version: int = 2, signing: Signing | None = None) -> Self: ...
    def encode(self, message: MessageBase, now: float | None = None) -> bytes:
        """Encode the next message as a packet, and advance the sequence number.

        Args:
            message: The message to encode.
            now: Current Unix time in seconds, used for signing only; None advances the signing timestamp by one unit.

        Returns:
            The bytes of the packet.

        Raises:
            EncodeError: The version cannot carry the message or the signature.
            SigningError: `now` is not a valid time for signing.
        """

    sequence: int
    """Sequence number of the next packet, 0 to 255."""

    @property
    def system(self) -> int:
        """System id of the sender."""

    @property
    def component(self) -> int:
        """Component id of the sender."""

    @property
    def version(self) -> int:
        """MAVLink version of the packets, 1 or 2."""

    @property
    def signing(self) -> Signing | None:
        """Signing state of the link, or None."""

def looks_timestamped(head: Buffer, dialect: HasCoreDialect) -> bool:
    """Return whether a file has a timestamp before each packet, as in a tlog.

    Args:
        head: The beginning of the file; at most 256 KiB are examined.
        dialect: The dialect whose packets are searched for.

    Returns:
        True if most packets have 8 bytes before them, False if they follow each other directly.
    """

@final
class UlogIndex:
    """Index of a PX4 ULog, built without the interpreter lock.

    A row of a table holds the time in microseconds (int64), the instance (uint8), three unused bytes and the fields of
    the record without padding; its size is a multiple of four bytes.

    Args:
        data: A read-only buffer, such as bytes or a map opened for reading; it must not change.
        size: Number of bytes to index; None for the whole file.
        positions: True to store the positions of the records, which `decode` needs; False to count them only.
        threads: Maximum number of threads.
        step: Number of bytes that are indexed at a time; None for all.
        done: Called with the beginning and the end of each part of the data that is indexed; its result is ignored.

    Raises:
        BufferError: The buffer is writable or not contiguous.
        ValueError: The buffer is no ULog, or uses features that are not supported.
    """

    def __new__(
        cls,
        data: Buffer,
        *,
        size: int | None = None,
        positions: bool = True,
        threads: int = 1,
        step: int | None = None,
        done: Callable[[int, int], object] | None = None,
    ) -> Self: ...
    def save(self) -> bytes:
        """Return the index as bytes, which `restore` takes."""

    @staticmethod
    def restore(saved: bytes, data: Buffer, *, threads: int = 1) -> UlogIndex | None:
        """Return the index of a whole file that was saved, without reading the file again.

        Args:
            saved: The bytes that `save` returned.
            data: A read-only buffer with the indexed bytes.
            threads: Maximum number of threads.

        Returns:
            The index, or None if the bytes cannot be those of an index of this file.

        Raises:
            BufferError: The buffer is writable or not contiguous.
            ValueError: The buffer is no ULog, or uses features that are not supported.
        """

    def without_positions(self) -> Self:
        """Return the same index without the positions of the records, in less memory."""

    def following(self, size: int) -> Self | None:
        """Return the index of the next part of the file.

        Args:
            size: Number of bytes to index.

        Returns:
            The index, with the positions of its records, or None at the end of the file.
        """

    @property
    def version(self) -> int:
        """Version of the file format."""

    @property
    def start_time(self) -> int:
        """Time since boot in microseconds at which logging started."""

    @property
    def appended(self) -> list[int]:
        """Positions at which appended data begins."""

    @property
    def end(self) -> int:
        """Position of the first byte after the indexed part."""

    @property
    def has_positions(self) -> bool:
        """Whether the positions of the records are stored."""

    @property
    def instances(self) -> list[tuple[str, dict[int, int]]]:
        """Number of records of each instance, by topic."""

    @property
    def time_span(self) -> tuple[int, int] | None:
        """Earliest and latest time of a record in microseconds since boot, or None without records."""

    @property
    def definitions_end(self) -> int | None:
        """Position of the first subscription or logged text, where the definitions end; None if there is none."""

    @property
    def damage(self) -> list[tuple[str, int]]:
        """Numbers of bytes and messages that were not read, by reason."""

    @property
    def unsubscribed(self) -> dict[int, int]:
        """Number of records of each id without a usable subscription."""

    @property
    def unknown_kinds(self) -> dict[str, int]:
        """Number of messages of each unknown kind."""

    def layout(self, topic: str) -> tuple[int, list[tuple[str, str, int, int]]]:
        """Return the columns of a topic's table.

        Args:
            topic: Name of the topic.

        Returns:
            The size of a row in bytes, and for each column its name, its type as in ULog, the number of elements (0 for
            a single value) and its position in the row.

        Raises:
            KeyError: The file has no such topic.
        """

    def messages(
        self, kind: str, *, step: int | None = None, done: Callable[[int, int], object] | None = None
    ) -> list[tuple[int, int, bytes]]:
        """Return the messages of one kind that are not records.

        Args:
            kind: I, M, P, Q, L, C or O.
            step: Number of bytes of the file that are read at a time; None for all.
            done: Called with the beginning and the end of each part of the data that is read.

        Returns:
            For each message its position, the latest time of a record before it in microseconds since boot, and its
            body.
        """

    def decode(
        self, tables: Sequence[tuple[str, Buffer]], *, utc_offset: int | None = None, threads: int = 1
    ) -> None:
        """Decode the rows of several topics in one pass.

        Args:
            tables: For each topic its name and a writable buffer with the exact size of all its rows.
            utc_offset: UTC minus time since boot in microseconds; None if it is unknown.
            threads: Maximum number of threads.

        Raises:
            KeyError: The file has no such topic.
            ValueError: A buffer is read-only, has the wrong size or overlaps another, or the positions of the records
                were not stored.
        """

class Index:
    """Index of all packets of a buffer by message, built without the interpreter lock.

    A row of a table holds the time in microseconds (int64), system, component, sequence, version, and the full
    payload, padded to a multiple of four bytes.

    Args:
        data: A read-only buffer, such as bytes or a map opened for reading; it must not change.
        dialect: The dialect of the messages.
        timestamped: True if 8 bytes of time precede each packet, as in a tlog.
        threads: Maximum number of threads.

    Raises:
        BufferError: The buffer is writable or not contiguous.
    """

    def __new__(cls, data: Buffer, dialect: HasCoreDialect, *, timestamped: bool, threads: int = 1) -> Self: ...
    def save(self) -> bytes:
        """Return the index as bytes, which `restore` takes."""

    @property
    def has_positions(self) -> bool:
        """True if the index holds the positions of the packets, which `decode` needs."""

    def without_positions(self) -> Index:
        """Return the same index without the positions of the packets, in less memory."""

    @staticmethod
    def restore(saved: bytes, data: Buffer, dialect: HasCoreDialect) -> Index | None:
        """Return an index that was saved, without reading the file again.

        Args:
            saved: The bytes that `save` returned.
            data: A read-only buffer with the indexed bytes.
            dialect: The dialect of the messages.

        Returns:
            The index, or None if the bytes are not those of an index of this dialect and size.

        Raises:
            BufferError: The buffer is writable or not contiguous.
        """

    @property
    def counts(self) -> dict[int, int]:
        """Number of packets of each known message in the buffer, by message id."""

    @property
    def unknown(self) -> dict[int, int]:
        """Number of packets of each message id that is not in the dialect."""

    @property
    def statistics(self) -> Statistics:
        """Totals of the buffer."""

    @property
    def sources(self) -> dict[tuple[int, int], SourceStatistics]:
        """Statistics of each source, by (system, component)."""

    @property
    def time_span(self) -> tuple[int, int] | None:
        """Earliest and latest timestamp in microseconds since 1970, or None without timestamps."""

    def row_size(self, message_id: int) -> int:
        """Return the size of one row of a message's table.

        Args:
            message_id: Id of the message.

        Returns:
            The size in bytes.

        Raises:
            KeyError: The dialect has no message of that id.
        """

    def decode(self, tables: Sequence[tuple[int, Buffer]], *, threads: int = 1) -> None:
        """Decode the rows of several messages in one pass.

        Args:
            tables: For each message its id and a writable buffer with the exact size of all its rows.
            threads: Maximum number of threads.

        Raises:
            KeyError: The dialect has no message of that id.
            ValueError: A buffer is read-only, has the wrong size or overlaps another, or the index has no positions.
        """

@final
class MappingGuard:
    """Keeps a failing disk under a mapped file from ending the process.

    While the guard exists, a byte that the disk does not deliver (an error of the disk, a truncated file) reads as zero, as
    do all bytes of the mapping from then on, and `failed` becomes true.

    Args:
        data: The mapped file, a read-only `mmap.mmap` of the beginning of a file; it stays mapped as long as the guard.

    Raises:
        BufferError: The buffer is writable.
        OSError: The handler of the signal cannot be installed.
    """

    def __new__(cls, data: Buffer) -> Self: ...
    @property
    def failed(self) -> bool:
        """True if a byte of the mapping could not be read; all bytes are zeros since then."""

@final
class WindowIndexer:
    """Indexer of a file that is read piece by piece, in memory that does not grow with the file.

    Args:
        dialect: The dialect of the messages.
        timestamped: True if 8 bytes of time precede each packet, as in a tlog.
        threads: Maximum number of threads.
    """

    def __new__(cls, dialect: HasCoreDialect, *, timestamped: bool, threads: int = 1) -> Self: ...
    def next(self, data: Buffer, *, last: bool) -> tuple[Index, int]:
        """Index the complete packets of the next piece of the file.

        Args:
            data: A read-only buffer: the bytes left over from the previous piece and those that follow them.
            last: True if the file ends with this piece.

        Returns:
            The index of the piece, and the number of bytes at its beginning that are done with.

        Raises:
            BufferError: The buffer is writable or not contiguous.
        """

    @property
    def counts(self) -> dict[int, int]:
        """Number of packets of each known message so far, by message id."""

    @property
    def unknown(self) -> dict[int, int]:
        """Number of packets of each message id that is not in the dialect, so far."""

    @property
    def statistics(self) -> Statistics:
        """Totals so far."""

    @property
    def sources(self) -> dict[tuple[int, int], SourceStatistics]:
        """Statistics of each source so far, by (system, component)."""

    @property
    def time_span(self) -> tuple[int, int] | None:
        """Earliest and latest timestamp so far in microseconds since 1970, or None without timestamps."""

@final
class DataFlashLayout:
    """How the records of a definition become rows of a table.

    A row begins with 12 bytes: the time in microseconds (int64), the instance (uint8) and zeros.

    Args:
        record_length: Length of a record in bytes, header included.
        row_size: Size of a row in bytes.
        fields: For each field its format character, its conversion ("=" copies, "0" copies and clears the bytes after
            the NUL of a text, "*" divides an integer by 100 or, for "L", by 10^7, giving a float64), its position in
            the record and its position in the row.
        time: Format character and position in the record of the time, factor and offset: the time is the field times
            the factor plus the offset, in microseconds. None leaves the time unknown (NaT).
        instance: Format character and position in the record of the number of the instance, or None.

    Raises:
        ValueError: A field lies outside of the record or of the row, or has an unknown format character.
    """

    def __new__(
        cls,
        record_length: int,
        row_size: int,
        fields: Sequence[tuple[str, str, int, int]],
        *,
        time: tuple[str, int, int, int] | None = None,
        instance: tuple[str, int] | None = None,
    ) -> Self: ...
    @property
    def row_size(self) -> int:
        """Size of a row in bytes."""

@final
class DataFlashIndex:
    """Index of all records of a DataFlash log by definition, built without the interpreter lock.

    Args:
        data: A read-only buffer, such as bytes or a map opened for reading; it must not change.
        threads: Maximum number of threads.
        step: Number of bytes that are indexed at a time; None for all.
        done: Called with the beginning and the end of each part of the data that is indexed; its result is ignored.

    Raises:
        BufferError: The buffer is writable or not contiguous.
    """

    def __new__(
        cls,
        data: Buffer,
        *,
        threads: int = 1,
        step: int | None = None,
        done: Callable[[int, int], object] | None = None,
    ) -> Self: ...
    def save(self) -> bytes:
        """Return the index as bytes, which `restore` takes."""

    @property
    def has_positions(self) -> bool:
        """True if the index holds the positions of records; without them, the log is read again when rows are needed."""

    @staticmethod
    def restore(saved: bytes, data: Buffer) -> DataFlashIndex | None:
        """Return an index that was saved, without reading the log again.

        Args:
            saved: The bytes that `save` returned.
            data: A read-only buffer with the indexed bytes.

        Returns:
            The index, or None if the bytes cannot be those of an index of this log.

        Raises:
            BufferError: The buffer is writable or not contiguous.
        """

    def without_positions(self) -> Self:
        """Return the same index in less memory, which is slower to decode with."""

    @property
    def definitions(self) -> list[tuple[bytes, bytes, bytes, int]]:
        """The definitions as (name, format, labels, length of a record); their numbers are the slots of the tables."""

    @property
    def redefinitions(self) -> list[tuple[int, int, int]]:
        """Where type numbers got a definition, in file order: (position in the file, type number, slot)."""

    @property
    def counts(self) -> list[int]:
        """Number of records by slot."""

    @property
    def damage(self) -> dict[str, int]:
        """Counts of what did not become a row or is doubtful, by name."""

    @property
    def unknown(self) -> dict[int, int]:
        """Number of headers of each type number that has no definition."""

    def rows_before(self, position: int) -> list[int]:
        """Return the number of records of each slot that begin before a position in the file.

        Args:
            position: The position in bytes.
        """

    def positions(self, slot: int, first: int, count: int) -> list[int]:
        """Return the positions in the file of the records of a slot.

        Args:
            slot: The slot.
            first: Number of the first record.
            count: Number of records.
        """

    def neighbour_times(self, slot: int, timed: Sequence[tuple[int, DataFlashLayout]]) -> list[int]:
        """Return a time for each record of a slot whose records have none: the time of the record before it.

        Records before all timed ones get the time of the first timed record; without any it is -2**63 (NaT).

        Args:
            slot: The slot.
            timed: The slots whose records have a time, each with a layout that has it.
        """

    def decode(self, tables: Sequence[tuple[int, int, DataFlashLayout, Buffer]], *, threads: int = 1) -> None:
        """Decode rows of several tables in one pass.

        Args:
            tables: For each table its slot, the number of the first row, the layout, and a writable buffer whose size is
                a multiple of the size of a row.
            threads: Maximum number of threads.

        Raises:
            IndexError: The slot has fewer rows.
            ValueError: A buffer is read-only, has no size of whole rows or overlaps another.
        """

@final
class Claims:
    """The claims of senders on addresses, in numbers; see `mavstack.security.senders`.

    Args:
        silence: Seconds without a packet after which another sender may hold an address.
    """

    def __new__(cls, silence: float = 2.5) -> Self: ...
    def open(self, place: int, group: int, host: int, authority: int, now: float) -> int | None:
        """Add a sender.

        Args:
            place: Number of the link that it belongs to.
            group: Number of the group of redundant links that its link belongs to; 0: none.
            host: Number of the host that it comes from.
            authority: The proof of its identity, 0 to 4.
            now: Time in seconds.

        Returns:
            Its number; None: there are 4,096 senders.

        Raises:
            ValueError: There is no such authority.
        """

    def close(self, sender: int) -> None:
        """Remove a sender and its claims. Idempotent.

        Args:
            sender: Its number.
        """

    def set_authority(self, sender: int, authority: int) -> None:
        """Change the proof of a sender's identity; what an earlier one proved is withdrawn.

        Args:
            sender: Its number.
            authority: The proof of its identity, 0 to 4.

        Raises:
            ValueError: The sender is not open, or there is no such authority.
        """

    def touch(self, sender: int, now: float) -> None:
        """Record that bytes came from a sender, whatever they are.

        Args:
            sender: Its number.
            now: Time in seconds.
        """

    def hear(self, sender: int, system: int, component: int, authority: int, now: float) -> int:
        """Record a packet.

        Args:
            sender: Number of the sender that it came from.
            system: System id of the packet.
            component: Component id of the packet.
            authority: The proof of this packet, 0 to 4; that of the sender counts too.
            now: Time in seconds.

        Returns:
            The standing: 0 held, 1 new, 2 shared, 3 contested, 4 outranked.

        Raises:
            ValueError: The sender is not open, or there is no such authority.
        """

    def standing(self, sender: int, system: int, component: int, authority: int, now: float) -> int:
        """Return the standing that a packet would have, and record nothing; see `hear`."""

    def note_ground_station(self, sender: int, system: int, component: int, is_station: bool) -> None:
        """Record whether the heartbeat of a sender for an address is that of a ground station."""

    def note_boot_time(self, sender: int, system: int, component: int, boot_time: int, now: float) -> int:
        """Record a boot time.

        Args:
            sender: Number of the sender.
            system: System id of the packet.
            component: Component id of the packet.
            boot_time: Milliseconds since the boot.
            now: Time in seconds.

        Returns:
            0: the clock agrees; 1: the source rebooted; 2: another clock, of a sender that does not hold the address.
        """

    def routes(self, system: int, component: int) -> list[int] | None:
        """Return the senders that lead to a target; None: its system was never heard."""

    def claims_on(
        self, system: int, component: int
    ) -> list[tuple[int, int, float, float, bool, bool, bool]]:
        """Return the claims on an address, the holder's first, each as a tuple of its attributes."""

    def is_authenticated(self, system: int, component: int) -> bool:
        """Return whether an authenticated sender holds an address."""

    def addresses(self) -> list[tuple[int, int]]:
        """Return all claimed addresses, ordered."""

    def contradict(self, sender: int, system: int, component: int, contradiction: int, now: float) -> bool:
        """Record a contradiction.

        Args:
            sender: Number of the sender of the newer packet.
            system: System id of the packet.
            component: Component id of the packet.
            contradiction: Its number: 0 sender, 1 boot time, 2 unique id, 3 type, 4 position.
            now: Time in seconds.

        Returns:
            True if a conflict begins.

        Raises:
            ValueError: There is no such contradiction.
        """

    def conflict(self, system: int, component: int) -> tuple[float, float, list[int], list[int]] | None:
        """Return the conflict about an address as a tuple of its attributes; None: there is no conflict."""

    def end_conflicts(self, now: float) -> list[tuple[int, int]]:
        """End the conflicts without a contradiction in 30 seconds, and return their addresses."""

    def first_to_evict(self, place: int | None, host: int, authority: int, now: float) -> int | None:
        """Return the sender that makes room for a new one; None: no sender does, and the new one is refused.

        Args:
            place: Number of the link whose senders may make room, and of the new one; None: all links.
            host: Number of the host that the new sender comes from.
            authority: The proof of its identity, 0 to 4.
            now: Time in seconds.

        Raises:
            ValueError: There is no such authority.
        """

@final
class DatagramSender:
    """A UDP socket that sends several datagrams per system call, where the system can.

    Args:
        descriptor: The descriptor of the socket, which is duplicated.

    Raises:
        OSError: The descriptor is not open.
    """

    def __new__(cls, descriptor: int) -> Self: ...
    def send(self, datagrams: list[tuple[bytes, tuple[object, ...]]]) -> tuple[int, bool]:
        """Send datagrams in order until the system refuses one.

        Args:
            datagrams: The datagrams, each with the address of its receiver.

        Returns:
            The number of datagrams that were sent; and True if the system accepts no more at the moment, False if it
            sent all or refused the next one for another reason.
        """

    @property
    def calls(self) -> int:
        """The number of system calls so far."""

@final
class Intake:
    """The input of a node: a thread that reads sockets and streams, and the latest packet of each source and message.

    A packet is kept from the program if its source was granted on its channel and the program decided that no part of
    it waits for its message; all others wait in a queue. The latest packets are kept of systems that are followed.

    Args:
        dialect: A `mavstack.Dialect` or a dialect module, which defines the messages.
        boot_fields: The offset of the boot time in the payload of each message that has one, by message id.
        position_fields: The id of the message with a position, and the offsets of its latitude, longitude and
            speeds to
            north and east.
        heading_fields: The id of the message with an attitude, and the offsets of its roll, pitch, yaw and yaw
            speed.
    """

    def __new__(
        cls,
        dialect: HasCoreDialect,
        boot_fields: dict[int, int],
        position_fields: Sequence[int],
        heading_fields: Sequence[int],
    ) -> Self: ...
    def start(self, now: float) -> int:
        """Start the thread; return a descriptor that is readable while something waits.

        Args:
            now: The time of the program's clock in seconds.

        Raises:
            OSError: The system has no more threads or descriptors.
        """

    def stop(self) -> None:
        """End the thread, and drop the packets that wait. Idempotent."""

    def add_socket(self, socket: int, descriptor: int) -> None:
        """Read a UDP socket, whose descriptor is duplicated, from now on.

        Args:
            socket: The number of the socket, chosen by the program.
            descriptor: The descriptor.

        Raises:
            OSError: The descriptor is not open.
            RuntimeError: The thread does not run.
        """

    def add_stream(self, channel: int, descriptor: int, is_terminal: bool) -> None:
        """Read a stream, whose descriptor is duplicated, from now on, for a channel that was given to `attach_fed`.

        It is not read while too many packets wait, so that the system slows down its sender. When it ends, `take`
        returns its number after its last packet.

        Args:
            channel: The number of the channel.
            descriptor: The descriptor of a connection or a serial port.
            is_terminal: It is a serial port or another terminal.

        Raises:
            OSError: The descriptor is not open, or the system cannot wait for it.
            RuntimeError: The thread does not run.
        """

    def remove_socket(self, socket: int) -> None:
        """Read a socket or stream no more; its copy is closed when the call returns. Idempotent.

        Args:
            socket: The number of the socket, or of the stream's channel.
        """

    def hurry(self, seconds: float) -> bool:
        """Let no packet rest for some time, because the program waits for an answer.

        Args:
            seconds: The time.

        Returns:
            True if the program is to wait for the sockets itself from now on, and to call `take` if one has
            something.
        """

    def attach(self, channel: int, socket: int, address: tuple[Any, ...], parser: Parser) -> bool:
        """Parse the datagrams of a peer, from the oldest of those that wait for the program.

        Args:
            channel: The number of the channel, chosen by the program.
            socket: The number of its socket.
            address: The address of the peer; port 0: any port of the host.
            parser: The parser of the channel, which both use.

        Returns:
            False if the host is not an IP address: its datagrams go on to the program.
        """

    def attach_fed(self, channel: int, parser: Parser) -> None:
        """Parse what `feed` gives of a channel that the program reads itself.

        Args:
            channel: The number of the channel, chosen by the program.
            parser: The parser of the channel, which both use.
        """

    def feed(self, channel: int, data: Buffer, now: float) -> bool:
        """Parse bytes that the program received on a channel; `take` returns the packets.

        Args:
            channel: The number of the channel.
            data: The bytes.
            now: The time of their arrival in seconds.

        Returns:
            True if there is a valid packet among them.
        """

    def detach(self, channel: int) -> tuple[int, int, float, float]:
        """Give the datagrams of a channel to the program from now on. Idempotent.

        Args:
            channel: The number of the channel.

        Returns:
            What was received since the last call, as `activity` does.
        """

    def activity(self, channel: int) -> tuple[int, int, float, float]:
        """Return the activity of a channel since the last call.

        Args:
            channel: The number of the channel.

        Returns:
            Bytes, datagrams, and the times of the last datagram and of the last valid packet; 0: none.
        """

    def grant(self, channel: int, source: tuple[int, int]) -> bool:
        """Let packets of a source on a channel be kept from the program, from the oldest one that waits for it.

        Args:
            channel: The number of the channel.
            source: System and component id.

        Returns:
            False if the intake does not parse that channel.
        """

    def revoke(self, source: tuple[int, int]) -> list[tuple[int, float, tuple[int, float] | None]]:
        """Give every packet of a source to the program again.

        Args:
            source: System and component id.

        Returns:
            The channels on which it was granted, with the times of its last packets, 0: none, and with its last
            expected boot times as `boot` returns them.
        """

    def revoke_all(self) -> None:
        """Give every packet to the program again."""

    def expect_boot(self, channel: int, source: tuple[int, int], boot: tuple[int, float] | None) -> None:
        """Set or take back the boot time that the next packets of a granted source have if it does not reboot.

        Args:
            channel: The number of the channel.
            source: System and component id.
            boot: The boot time in milliseconds, and the time of its packet; None takes it back.
        """

    def boot(self, channel: int, source: tuple[int, int]) -> tuple[int, float] | None:
        """Return the last expected boot time of a granted source, in milliseconds, and the time of its packet; None if
        none is expected.

        Args:
            channel: The number of the channel.
            source: System and component id.
        """

    def sources(self) -> list[tuple[int, tuple[int, int], float, tuple[int, float] | None]]:
        """Return the granted sources: channel, source, time of the last packet or 0, and what `boot` returns."""

    def decide(
        self,
        source: tuple[int, int],
        message_id: int,
        level: int,
        listeners: tuple[Callable[[Packet], None], ...],
    ) -> None:
        """Decide who takes a message of a source.

        Args:
            source: System and component id.
            message_id: The message id.
            level: The interest of services; 0: not known, 1: none, 2: in boot times, positions and headings that
                do not continue those before, 3: in every packet, soon, 4: in every packet, at once.
            listeners: The functions that `deliver` calls with every packet.

        Raises:
            ValueError: There is no such level.
        """

    def forget_decisions(self, message_id: int | None, system: int) -> None:
        """Forget the decisions about a message.

        Args:
            message_id: The message id; None: all.
            system: The system id; 0: all.
        """

    def take(
        self,
    ) -> tuple[
        list[tuple[int, list[Packet], list[Packet], bool]],
        list[tuple[int, tuple[Any, ...], bytes, int]],
        list[tuple[tuple[int, int], int]],
        list[tuple[int, int]],
        bool,
    ]:
        """Remove and return the packets and datagrams that wait, after the sockets were read if the program is to do so.

        Returns:
            The packets, in order, as (channel, those for the engine, those for listeners, kept as latest packets
            already; of those that are not kept the listeners are not known); the datagrams of senders that the
            intake does not parse, as (socket, address, data, number of datagrams); the messages to `decide` about,
            as (source, message id); the sockets that the program must read itself from now on, because it did not
            keep up, and the streams, because they ended, each with the number of the error or 0; and whether the
            program is to wait for the other ones from now on, as `hurry` returns it.
        """

    def deliver(
        self,
        packets: list[Packet],
        find: Callable[[Packet], tuple[Callable[[Packet], None], ...]],
        fail: Callable[[Exception], None],
    ) -> None:
        """Call the listeners of packets, in order.

        Args:
            packets: The packets.
            find: Called with each packet whose listeners were not given to `decide`; returns their functions.
            fail: Called with each exception of a listener.

        Raises:
            BaseException: A listener raised an exception that is not an `Exception`.
        """

    def follow(self, system: int) -> None:
        """Keep the latest packets of a system from now on.

        Args:
            system: The system id.
        """

    def unfollow(self, system: int) -> None:
        """End one `follow`.

        Args:
            system: The system id.
        """

    def clear(self, system: int) -> None:
        """Drop the latest packets of a system.

        Args:
            system: The system id.
        """

    def keep(self, packet: Packet, now: float) -> None:
        """Keep a packet as the latest of its message, if its system is followed.

        Args:
            packet: The packet.
            now: The time of its arrival in seconds.

        Raises:
            TypeError: It is not a packet.
        """

    def latest(self, source: tuple[int, int], message_id: int) -> tuple[Packet, float] | None:
        """Return the latest packet of a message, and the time of its arrival.

        Args:
            source: System and component id.
            message_id: The message id.

        Returns:
            The packet, the same object until the next one arrives, and the time; None if there is none.
        """

    def received_at(self, source: tuple[int, int], message_id: int) -> float | None:
        """Return the time of the latest packet of a message; None if there is none.

        Args:
            source: System and component id.
            message_id: The message id.
        """

    def newest_time(self, system: int) -> float | None:
        """Return the time of the latest packet of a system; None if there is none.

        Args:
            system: The system id.
        """

    def stored(self, system: int) -> int:
        """Return the number of messages of a system of which a packet is kept.

        Args:
            system: The system id.
        """

class PacketRouter:
    """The decision of the router where each packet goes, without sockets and threads.

    Args:
        dialect: A `mavstack.Dialect` or a dialect module, which defines the messages.
    """

    def __new__(cls, dialect: HasCoreDialect) -> Self: ...
    def add_port(self, group: str | None = None) -> int:
        """Add a place that packets come from and go to.

        Args:
            group: Name of a group of redundant links, or None.

        Returns:
            The number of the port; numbers of removed ports are used again.

        Raises:
            RuntimeError: There are 4,096 ports already.
        """

    def remove_port(self, port: int) -> None:
        """Remove a port and its routes. Idempotent.

        Args:
            port: The port.
        """

    def route(self, port: int, packet: Buffer, now: float) -> list[int]:
        """Learn from a packet, and return the ports that it goes to.

        Args:
            port: The port on which it was received.
            packet: The bytes of exactly one valid packet.
            now: Current time in seconds, of any clock that does not run back.

        Returns:
            The ports; empty if the packet is dropped.

        Raises:
            ValueError: The port is not open, or the bytes are not one packet.
        """

# (action, messages, systems, components, target systems, commands, rate, name, dry run)
RuleLayout: TypeAlias = tuple[
    str, Sequence[int], Sequence[int], Sequence[int], Sequence[int], Sequence[int], float | None, str, bool
]

@final
class RouterCore:
    """A router on a thread of its own; see `mavstack.router.RouterEngine`.

    Args:
        dialect: A `mavstack.Dialect` or a dialect module, which defines the messages.
        duplicate_window: Seconds within which copies of a packet on other endpoints are dropped.

    Raises:
        OSError: The system has no more threads or descriptors.
    """

    def __new__(cls, dialect: HasCoreDialect, duplicate_window: float) -> Self: ...
    def add_udp(self, descriptor: int, peer: tuple[str, int] | None, idle: float, max_peers: int, trusts_senders: bool) -> int:
        """Add a UDP socket, whose descriptor is duplicated; return the number of the endpoint."""

    def add_stream(self, descriptor: int, has_lengths: bool, queue_bytes: int) -> int:
        """Add a stream, whose descriptor is duplicated; return the number of the endpoint."""

    def add_queue(self, capacity: int) -> int:
        """Add an endpoint whose bytes the program carries; return its number."""

    def start(self, endpoint: int) -> None:
        """Open an endpoint that was added; nothing passes it before."""

    def push(self, endpoint: int, data: Buffer) -> bool | None:
        """Route bytes from the program; return whether there was room, or None if the endpoint is no queue."""

    def pull(self, endpoint: int) -> list[bytes] | None:
        """Return the packets for the program, oldest first, or None if the endpoint is no queue."""

    def remove(self, endpoint: int) -> None:
        """Remove an endpoint."""

    def pause(self, endpoint: int, paused: bool) -> None:
        """Pause an endpoint, or let it continue."""

    def set_rules(
        self,
        endpoint: int,
        incoming: Sequence[RuleLayout],
        outgoing: Sequence[RuleLayout],
        default_incoming: str,
        default_outgoing: str,
        bytes_per_second: float | None,
    ) -> None:
        """Set the rules of an endpoint."""

    def set_group(self, endpoint: int, group: str | None) -> None:
        """Set the group of an endpoint."""

    def set_listen_only(self, endpoint: int, listen_only: bool) -> None:
        """Drop packets from an endpoint, or accept them."""

    def set_monitor(self, endpoint: int, monitor: bool) -> None:
        """Give an endpoint a copy of every accepted packet, or no longer."""

    def set_allowed_peers(self, endpoint: int, ranges: Sequence[tuple[str, int, int, int]] | None) -> None:
        """Set the ranges of peers that a listening socket accepts."""

    def set_blocked_peers(self, endpoint: int, peers: Sequence[tuple[str, int]]) -> None:
        """Cut off peers of a listening socket, and free all others."""

    def set_authority(self, endpoint: int, authority: int) -> None:
        """Set how the identity of the peer of an endpoint is proven, 0 to 4."""

    def set_signing(
        self,
        endpoint: int,
        incoming: Signing | None,
        outgoing: Signing | None,
        allow_unsigned: Sequence[int],
        strip: bool,
    ) -> None:
        """Set the signing of an endpoint; the state of the keys is shared with the given objects."""

    def decide(self, token: int, passed: bool) -> None:
        """Pass or drop a packet that waits for a decision."""

    def statistics(self) -> dict[str, Any]:
        """Return the counters of all endpoints and the learned routes."""

    def events(self) -> list[tuple[Any, ...]]:
        """Return the events since the last call, oldest first, as tuples."""

    def fileno(self) -> int:
        """Return the descriptor that is readable while events wait."""

    def close(self) -> None:
        """End the engine, and close all endpoints."""
