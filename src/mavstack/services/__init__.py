"""MAVLink's microservices as sans-IO state machines, client and server, a package each."""

from mavstack.services.addressing import BROADCAST, Address, message_ids, target_of
from mavstack.services.operation import Client, Operation, OperationEnded, Progress
from mavstack.services.pause import Pause
from mavstack.services.procedure import Procedure
from mavstack.services.service import Event, HasRoom, Outgoing, Priority, Service, always_room, earliest
from mavstack.services.timing import DEFAULT_WAIT_TIMEOUT, RoundTrip

__all__ = [
    "BROADCAST",
    "DEFAULT_WAIT_TIMEOUT",
    "Address",
    "Client",
    "Event",
    "HasRoom",
    "Operation",
    "OperationEnded",
    "Outgoing",
    "Pause",
    "Priority",
    "Procedure",
    "Progress",
    "RoundTrip",
    "Service",
    "always_room",
    "earliest",
    "message_ids",
    "target_of",
]
