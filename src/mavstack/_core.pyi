"""The compiled core: everything that touches every byte or packet. Policy lives above it, in Python."""

from collections.abc import Callable, Sequence
from typing import Any, Protocol, Self, TypeAlias, dataclass_transform, final

from typing_extensions import Buffer

# (name, type, array length or 0, offset in the full payload, read as enum)
FieldLayout: TypeAlias = tuple[str, str, int, int, bool]
# (id, name, CRC_EXTRA, payload length without extensions, payload length with them, fields in definition order)
MessageLayout: TypeAlias = tuple[int, str, int, int, int, Sequence[FieldLayout]]

class HasCoreDialect(Protocol):
    """A `mavstack.Dialect` or a dialect module such as `mavstack.dialects.common`."""

    @property
    def core_dialect(self) -> Dialect: ...

def crc16(data: Buffer, crc: int = 0xFFFF) -> int:
    """CRC-16/MCRF4XX of `data`, continued from `crc`."""

@final
class Dialect:
    """Layout tables of one dialect; classes are asked of `make_class` on first use."""

    def __new__(
        cls, name: str, messages: Sequence[MessageLayout], make_class: Callable[[int], type[MessageBase]]
    ) -> Self: ...
    @property
    def name(self) -> str: ...
    @property
    def core_dialect(self) -> Dialect: ...
    def __len__(self) -> int: ...
    def __contains__(self, message_id: int) -> bool: ...

def new_message_class(
    name: str,
    bases: tuple[type, ...],
    namespace: dict[str, Any],
    layout: MessageLayout,
    template: Buffer | None = None,
) -> type[MessageBase]:
    """Make a message class whose fields read and write the payload bytes.

    `template` is the payload of a message made without arguments, zero where it ends.

    The class must offer `_enum_values(field_name) -> (dict[int, member], fallback or None)` as a class method:
    asked once per enum field, on first read; `fallback(int)` is called for values the dict lacks.
    """

@dataclass_transform(eq_default=False)
class MessageMeta(type): ...

class MessageBase(metaclass=MessageMeta):
    """Base of message classes: positional or keyword fields, zero where not given."""

    def __new__(cls, *args: Any, **fields: Any) -> Self: ...
    def to_payload(self, version: int = 2, /) -> bytes:
        """The payload as sent: 2 trims trailing zero bytes, 1 leaves the extensions out."""

    @classmethod
    def from_payload(cls, payload: Buffer, /) -> Self:
        """A message over `payload`, zero-filled if short, cut if longer than known."""

@final
class Statistics:
    """Totals of one byte stream."""

    @property
    def packets(self) -> int: ...
    @property
    def packet_bytes(self) -> int: ...
    @property
    def version_1(self) -> int: ...
    @property
    def version_2(self) -> int: ...
    @property
    def signed(self) -> int: ...
    @property
    def unknown(self) -> int:
        """Packets whose id the dialect does not have."""

    @property
    def bad_bytes(self) -> int:
        """Bytes that belong to no packet."""

    @property
    def bad_checksum(self) -> int: ...
    @property
    def bad_flags(self) -> int:
        """False magics or packets with an incompatibility flag that is not known."""

    @property
    def bad_length(self) -> int:
        """MAVLink 1 packets shorter than their message."""

@final
class SourceStatistics:
    """What was heard of one system and component on one link."""

    @property
    def received(self) -> int: ...
    @property
    def bytes(self) -> int: ...
    @property
    def lost(self) -> int: ...
    @property
    def late(self) -> int: ...
    @property
    def loss(self) -> float:
        """Share of the packets sent that were lost, 0 to 1."""

@final
class Refusals:
    """How many packets signing refused, by reason."""

    @property
    def unsigned(self) -> int: ...
    @property
    def forged(self) -> int: ...
    @property
    def replayed(self) -> int: ...
    @property
    def stale(self) -> int: ...
    @property
    def future(self) -> int: ...
    @property
    def too_many_streams(self) -> int: ...
    @property
    def total(self) -> int: ...

@final
class Signing:
    """Signs what is sent on a link and judges what is received; give one to its parser and its encoder.

    `timestamp` is where the clock starts (10 µs since 2015): the value persisted by the last run. The limits
    are in seconds: how far behind the clock a new stream may begin, how far ahead of it a packet may be, and
    how far behind its stream's newest a reordered packet may come (0: never).
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
    def link_id(self) -> int: ...
    @property
    def timestamp(self) -> int:
        """Newest timestamp signed or accepted: persist it, and start the next run with it."""

    @property
    def streams(self) -> int: ...
    @property
    def refusals(self) -> Refusals: ...

@final
class Packet:
    """A packet, byte for byte as it came; `Packet(raw, dialect)` raises ValueError if `raw` is not exactly one."""

    def __new__(cls, raw: Buffer, dialect: HasCoreDialect, timestamp: int | None = None) -> Self: ...
    @property
    def message(self) -> Any:
        """The message, or `None` if the dialect does not have its id."""

    @property
    def name(self) -> str | None:
        """Official name of the message, or `None` if the dialect does not have its id."""

    @property
    def version(self) -> int: ...
    @property
    def message_id(self) -> int: ...
    @property
    def system(self) -> int: ...
    @property
    def component(self) -> int: ...
    @property
    def sequence(self) -> int: ...
    @property
    def incompat_flags(self) -> int: ...
    @property
    def compat_flags(self) -> int: ...
    @property
    def signed(self) -> bool:
        """Whether the packet carries a signature; that it is a good one only a parser with signing says."""

    @property
    def link_id(self) -> int | None: ...
    @property
    def signature_timestamp(self) -> int | None: ...
    @property
    def signature(self) -> bytes | None: ...
    @property
    def timestamp(self) -> int | None:
        """Microseconds since 1970 recorded before the packet, or `None` outside a timestamped stream."""

    @property
    def checksum(self) -> int: ...
    @property
    def payload(self) -> bytes:
        """The payload as it came: trimmed, whole, or longer than known."""

    @property
    def raw(self) -> bytes: ...
    def __len__(self) -> int: ...

@final
class Parser:
    """Finds the packets of one byte stream, however it is cut into chunks; what is not a packet is counted.

    With `signing`, packets that it refuses are left out. `timestamped` reads a tlog: 8 bytes of time before
    each packet.
    """

    def __new__(cls, dialect: HasCoreDialect, *, signing: Signing | None = None, timestamped: bool = False) -> Self: ...
    def feed(self, data: Buffer, now: float | None = None) -> list[Packet]:
        """The packets that `data` completes; `now` is the Unix time in seconds, needed for signing only."""

    def flush(self, now: float | None = None) -> list[Packet]:
        """Ends the stream: the packets that an unfinished one at its end may have hidden."""

    @property
    def dialect(self) -> Dialect: ...
    @property
    def signing(self) -> Signing | None: ...
    @property
    def statistics(self) -> Statistics: ...
    @property
    def sources(self) -> dict[tuple[int, int], SourceStatistics]:
        """What was heard of each (system, component), and how much of it was lost."""

    @property
    def pending(self) -> int:
        """Bytes that wait for more."""

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
    """The packet that carries `message`; raises EncodeError if the version cannot carry it."""

@final
class Encoder:
    """Encodes the messages of one component for one link, and counts their sequence."""

    def __new__(cls, system: int, component: int, *, version: int = 2, signing: Signing | None = None) -> Self: ...
    def encode(self, message: MessageBase, now: float | None = None) -> bytes:
        """The packet that carries `message`; `now` is the Unix time in seconds, needed for signing only."""

    sequence: int
    @property
    def system(self) -> int: ...
    @property
    def component(self) -> int: ...
    @property
    def version(self) -> int: ...
    @property
    def signing(self) -> Signing | None: ...

def looks_timestamped(head: Buffer, dialect: HasCoreDialect) -> bool:
    """Whether a file that begins with `head` has a timestamp before each packet."""

@final
class Index:
    """Where every packet of a read-only buffer is, by message; built without the interpreter lock.

    A row of a table: time in microseconds (int64), system, component, sequence, version, the payload in wire
    layout with extensions, padding to a multiple of four.
    """

    def __new__(cls, data: Buffer, dialect: HasCoreDialect, *, timestamped: bool, threads: int = 1) -> Self: ...
    @property
    def counts(self) -> dict[int, int]: ...
    @property
    def unknown(self) -> dict[int, int]: ...
    @property
    def statistics(self) -> Statistics: ...
    @property
    def sources(self) -> dict[tuple[int, int], SourceStatistics]: ...
    @property
    def time_span(self) -> tuple[int, int] | None: ...
    def row_size(self, message_id: int) -> int: ...
    def decode(self, tables: Sequence[tuple[int, Buffer]], *, threads: int = 1) -> None:
        """Fill tables, given as (message id, writable buffer of exactly the rows' bytes), all in one go."""
