"""A node of DroneCAN: it reports its status each second, and who it is and its parameters when it is asked.

    message   priority 5 · type 16 · 0 · source 7
    service   priority 5 · type 8 · request 1 · destination 7 · 1 · source 7

The last byte of each frame is its tail: start, end, toggle and the transfer id. A transfer of several frames
begins with its CRC, which starts with the signature of the data type. Source: DroneCAN, specification 4.1.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.services.can import CanFrame

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

NODE_STATUS: Final = 341
GET_NODE_INFO: Final = 1
GET_NODE_INFO_SIGNATURE: Final = 0xEE468A8121C46A9E
EXECUTE_OPCODE: Final = 10
EXECUTE_OPCODE_SIGNATURE: Final = 0x3B131AC5EB69D2CD
GET_SET: Final = 11
GET_SET_SIGNATURE: Final = 0xA7B622F939D1A4D5
#: The tags of a value that is missing, and of a whole number.
_EMPTY, _INTEGER = 0, 1
_INTEGER_SIZE: Final = 8
_STATUS_PRIORITY: Final = 20
_SERVICE_PRIORITY: Final = 16
_SERVICE: Final = 0x80
_REQUEST: Final = 1 << 15
_START, _END, _TOGGLE = 0x80, 0x40, 0x20
_FRAME_DATA: Final = 7
_MAX_TRANSFER: Final = 4096


def transfer_frames(number: int, payload: bytes, transfer_id: int, signature: int) -> list[CanFrame]:
    """Return the frames of a transfer.

    Args:
        number: The identifier of its frames.
        payload: The payload.
        transfer_id: Its number; the last five bits count.
        signature: The signature of the data type.
    """
    tail = transfer_id & 0x1F
    if len(payload) <= _FRAME_DATA:
        return [CanFrame(number, payload + bytes((_START | _END | tail,)))]
    data = _crc(payload, signature).to_bytes(2, "little") + payload
    parts = [data[index : index + _FRAME_DATA] for index in range(0, len(data), _FRAME_DATA)]
    last = len(parts) - 1
    return [
        CanFrame(number, part + bytes((tail | _START * (not n) | _END * (n == last) | _TOGGLE * (n % 2),)))
        for n, part in enumerate(parts)
    ]


class TransferReceiver:
    """Joins the frames of transfers; a lost or repeated frame loses its transfer."""

    def __init__(self) -> None:
        self._open: dict[int, tuple[int, bytearray]] = {}

    def add(self, frame: CanFrame, signature: int) -> bytes | None:
        """Return the payload of the transfer that a frame completes, or None."""
        if not frame.data or not frame.extended or frame.remote or frame.error:
            return None
        tail, data = frame.data[-1], frame.data[:-1]
        if tail & _START and tail & _END:
            self._open.pop(frame.id, None)
            return data
        if tail & _START:
            self._open = {frame.id: (tail & 0x1F | _TOGGLE, bytearray(data)), **self._open}
            return None
        expected, joined = self._open.get(frame.id, (-1, bytearray()))
        if tail & ~_END != expected or len(joined) > _MAX_TRANSFER:
            self._open.pop(frame.id, None)
            return None
        joined += data
        self._open[frame.id] = expected ^ _TOGGLE, joined
        if not tail & _END:
            return None
        del self._open[frame.id]
        payload = bytes(joined[2:])
        return payload if _crc(payload, signature).to_bytes(2, "little") == joined[:2] else None


@dataclass(slots=True)
class DroneCanNode:
    """A node on a bus.

    Attributes:
        number: Its node id, 1 to 127.
        name: Its name, such as "org.example.gps".
        unique_id: Its unique id, 16 bytes.
        started: When it started, Unix seconds.
        parameters: Its parameters, whole numbers by name.
    """

    number: int
    name: str
    unique_id: bytes
    started: float
    parameters: dict[str, int] = field(default_factory=dict)
    version: tuple[int, int] = (1, 4)
    _transfers: int = 0
    _receiver: TransferReceiver = field(default_factory=TransferReceiver)

    def status_frames(self, now: float) -> list[CanFrame]:
        """Return the frames of its status (uavcan.protocol.NodeStatus)."""
        self._transfers += 1
        number = _STATUS_PRIORITY << 24 | NODE_STATUS << 8 | self.number
        return transfer_frames(number, self._status(now), self._transfers, 0)

    def answer(self, frame: CanFrame, now: float) -> list[CanFrame]:
        """Return the frames of its answer to a frame on the bus; empty if there is none."""
        is_request = bool(frame.id & _SERVICE) and bool(frame.id & _REQUEST)
        service = frame.id >> 16 & 0xFF
        if not is_request or frame.id >> 8 & 0x7F != self.number or service not in _SERVICES:
            return []
        signature, respond = _SERVICES[service]
        request = self._receiver.add(frame, signature)
        if request is None:
            return []
        client = frame.id & 0x7F
        number = _SERVICE_PRIORITY << 24 | service << 16 | client << 8 | _SERVICE | self.number
        return transfer_frames(number, respond(self, request, now), frame.data[-1], signature)

    def _status(self, now: float) -> bytes:
        uptime = max(int(now - self.started), 0) & 0xFFFFFFFF
        # Health OK, mode operational, no vendor-specific status.
        return uptime.to_bytes(4, "little") + bytes(3)

    def info(self, request: bytes, now: float) -> bytes:
        """Return who the node is (uavcan.protocol.GetNodeInfo)."""
        major, minor = self.version
        software = bytes((major, minor, 1)) + (0x5EED0001).to_bytes(4, "little") + bytes(8)
        hardware = bytes((1, 0)) + self.unique_id[:16].ljust(16, b"\0") + bytes(1)
        return self._status(now) + software + hardware + self.name.encode("ascii", "replace")[:80]

    def get_set(self, request: bytes, now: float) -> bytes:
        """Return a parameter by its name or index, set before if the request has a value (param.GetSet)."""
        low, high = request[:2].ljust(2, b"\0")
        index, tag = high >> 3 << 8 | low, high & 7
        names, value = list(self.parameters), request[2 : 2 + _INTEGER_SIZE]
        name = request[2 + _INTEGER_SIZE * (tag == _INTEGER) :].decode("ascii", "replace")
        name = name or (names[index] if index < len(names) else "")
        if name not in self.parameters:
            return bytes(4)
        if tag == _INTEGER and len(value) == _INTEGER_SIZE:
            self.parameters[name] = int.from_bytes(value, "little", signed=True)
        content = self.parameters[name].to_bytes(_INTEGER_SIZE, "little", signed=True)
        # No default, maximum and minimum.
        return bytes((_INTEGER,)) + content + bytes((_EMPTY,) * 3) + name.encode()

    def execute(self, request: bytes, now: float) -> bytes:
        """Accept that the parameters are saved (param.ExecuteOpcode): an argument of 0, and success."""
        return bytes(6) + b"\x80"


_SERVICES: Final[Mapping[int, tuple[int, Callable[[DroneCanNode, bytes, float], bytes]]]] = MappingProxyType(
    {
        GET_NODE_INFO: (GET_NODE_INFO_SIGNATURE, DroneCanNode.info),
        GET_SET: (GET_SET_SIGNATURE, DroneCanNode.get_set),
        EXECUTE_OPCODE: (EXECUTE_OPCODE_SIGNATURE, DroneCanNode.execute),
    }
)


def _crc(payload: bytes, signature: int) -> int:
    """Return the CRC of a transfer: CRC-16-CCITT over the signature and the payload."""
    crc = 0xFFFF
    for byte in signature.to_bytes(8, "little") + payload:
        crc ^= byte << 8
        for _ in range(8):
            crc = (crc << 1 ^ 0x1021 if crc & 0x8000 else crc << 1) & 0xFFFF
    return crc
