"""Malformed fields: counts above the size of their array, and coordinates that are on no globe.

A receiver that trusts a count reads behind the end of an array. The sizes come from the definitions; FTP has
its count inside its payload. A payload longer than the definition may be a newer version of the message, so
it passes.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, Final

from mavstack.dialects import common
from mavstack.router.firewall.detector import Detector
from mavstack.services import message_ids

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from mavstack.router.firewall.alerts import Alert
    from mavstack.wire import Packet

#: The field with the count, and the array that it counts, of each message that has them.
COUNTS: Final[Mapping[type, tuple[str, str]]] = MappingProxyType(
    {
        common.TrajectoryRepresentationWaypoints: ("valid_points", "pos_x"),
        common.TrajectoryRepresentationBezier: ("valid_points", "pos_x"),
        common.SerialControl: ("count", "data"),
        common.GpsRtcmData: ("len", "data"),
        common.GpsInjectData: ("len", "data"),
        common.LogData: ("count", "data"),
        common.Tunnel: ("payload_length", "payload"),
        common.LoggingData: ("length", "data"),
        common.LoggingDataAcked: ("length", "data"),
        common.CanFrame: ("len", "data"),
        common.CanfdFrame: ("len", "data"),
    }
)
#: Latitude and longitude in 1e-7 degrees, in messages whose frame is always global.
POSITIONS: Final[Mapping[type, tuple[str, str]]] = MappingProxyType(
    {
        common.SetPositionTargetGlobalInt: ("lat_int", "lon_int"),
        common.SetGpsGlobalOrigin: ("latitude", "longitude"),
        common.SetHomePosition: ("latitude", "longitude"),
    }
)
#: Place of the size in the payload of FTP, and of its data.
_FTP_SIZE, _FTP_DATA = 4, 12
_MAX_LATITUDE, _MAX_LONGITUDE = 900_000_000, 1_800_000_000


class MalformedFields(Detector):
    """Refuses messages whose counts or coordinates are out of their range."""

    name: ClassVar[str] = "malformed"
    messages: ClassVar[frozenset[int]] = message_ids(*COUNTS, *POSITIONS, common.FileTransferProtocol)

    def inspect(self, origin: str, packet: Packet, now: float) -> Iterator[Alert]:
        """Yield the alerts about a packet."""
        problem = _problem(packet.message)
        if problem is not None:
            yield self.alert(origin, packet, f"{packet.name}: {problem}")


def _problem(message: Any) -> str | None:  # noqa: ANN401 (a message of any class)
    """Return the reason why a message is malformed."""
    if isinstance(message, common.FileTransferProtocol):
        return _excess("size", message.payload[_FTP_SIZE], len(message.payload) - _FTP_DATA)
    for kind, (count, array) in COUNTS.items():
        if isinstance(message, kind):
            return _excess(count, getattr(message, count), len(getattr(message, array)))
    for kind, (latitude, longitude) in POSITIONS.items():
        if isinstance(message, kind):
            return _off_the_globe(getattr(message, latitude), getattr(message, longitude))
    return None


def _excess(name: str, count: int, size: int) -> str | None:
    return f"{name} is {count}, more than the {size} of its array" if count > size else None


def _off_the_globe(latitude: int, longitude: int) -> str | None:
    if abs(latitude) <= _MAX_LATITUDE and abs(longitude) <= _MAX_LONGITUDE:
        return None
    return f"{latitude / 1e7:.7f}, {longitude / 1e7:.7f} is not a position"
