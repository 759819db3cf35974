"""Remote ID (OPEN_DRONE_ID_…): what a vehicle's module reports, and the messages of the operator."""

from mavstack.services.remote_id.broadcast import decode_broadcast, encode_broadcast, encode_pack
from mavstack.services.remote_id.monitor import RemoteIdMonitor, RemoteIdStatus
from mavstack.services.remote_id.sender import Operator, RemoteIdSender

__all__ = [
    "Operator",
    "RemoteIdMonitor",
    "RemoteIdSender",
    "RemoteIdStatus",
    "decode_broadcast",
    "encode_broadcast",
    "encode_pack",
]
