"""Malformed fields: counts above the size of their array, and coordinates that are on no globe.

A receiver that trusts a count reads behind the end of an array. The sizes come from the definitions; FTP has
its count inside its payload. A payload longer than the definition may be a newer version of the message, so
it passes.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, Final

from mavstack.dialects import Dialect, common
from mavstack.router.firewall.detector import Detector
from mavstack.services import message_ids

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from mavstack.dialects.model import MessageDefinition
    from mavstack.router.firewall.alerts import Alert
    from mavstack.wire import Packet

#: The array that each count field counts. Messages of the current dialect that have both fields are checked.
COUNTS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "valid_points": "pos_x",
        "count": "data",
        "len": "data",
        "length": "data",
        "data_length": "data",
        "payload_length": "payload",
    }
)
#: The fields with latitude and longitude (in 1e-7 degrees) of messages whose frame is always global.
POSITIONS: Final[Mapping[type, tuple[str, str]]] = MappingProxyType(
    {
        common.SetPositionTargetGlobalInt: ("lat_int", "lon_int"),
        common.SetGpsGlobalOrigin: ("latitude", "longitude"),
        common.SetHomePosition: ("latitude", "longitude"),
    }
)
#: Offset of the field `size` in the payload of MAVLink FTP, and offset of its data.
_FTP_SIZE, _FTP_DATA = 4, 12
_MAX_LATITUDE, _MAX_LONGITUDE = 900_000_000, 1_800_000_000


class MalformedFields(Detector):
    """Refuses messages whose counts or coordinates are out of their range."""

    name: ClassVar[str] = "malformed"

    def __init__(self) -> None:
        self._counts: dict[int, tuple[str, str]] = {}
        self.messages = frozenset()
        self.use_dialect(Dialect.load("common"))

    def use_dialect(self, dialect: Dialect) -> None:
        """Look for the messages of the dialect that have counts."""
        numbers = {number for each in dialect.with_includes for number in each.table.ids.values()}
        counts = ((number, _count_of(dialect.message_definition(number))) for number in numbers)
        self._counts = {number: found for number, found in counts if found is not None}
        fixed = message_ids(*POSITIONS, common.FileTransferProtocol)
        self.messages = frozenset(self._counts) | fixed

    def inspect(self, origin: str, packet: Packet, now: float) -> Iterator[Alert]:
        """Yield the alerts about a packet."""
        problem = self._problem(packet.message_id, packet.message)
        if problem is not None:
            yield self.alert(origin, packet, f"{packet.name}: {problem}")

    def _problem(self, message_id: int, message: Any) -> str | None:  # noqa: ANN401 (a message of any class)
        """Return the reason why a message is malformed."""
        if isinstance(message, common.FileTransferProtocol):
            return _excess("size", message.payload[_FTP_SIZE], len(message.payload) - _FTP_DATA)
        if message_id in self._counts and message is not None:
            count, array = self._counts[message_id]
            return _excess(count, getattr(message, count), len(getattr(message, array)))
        for kind, (latitude, longitude) in POSITIONS.items():
            if isinstance(message, kind):
                return _off_the_globe(getattr(message, latitude), getattr(message, longitude))
        return None


def _count_of(definition: MessageDefinition) -> tuple[str, str] | None:
    """Return the field with a count and the array that it counts, if a message has them."""
    scalars = {field.name for field in definition.fields if not field.array_length}
    arrays = {field.name for field in definition.fields if field.array_length}
    pairs = ((count, array) for count, array in COUNTS.items() if count in scalars and array in arrays)
    return next(pairs, None)


def _excess(name: str, count: int, size: int) -> str | None:
    return f"{name} is {count}, more than the {size} of its array" if count > size else None


def _off_the_globe(latitude: int, longitude: int) -> str | None:
    if abs(latitude) <= _MAX_LATITUDE and abs(longitude) <= _MAX_LONGITUDE:
        return None
    return f"{latitude / 1e7:.7f}, {longitude / 1e7:.7f} is not a position"
