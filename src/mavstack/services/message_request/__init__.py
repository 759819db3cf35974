"""Messages on request, once or at a rate, by the commands and by the legacy data streams."""

from mavstack.services.message_request.client import RequestMessage
from mavstack.services.message_request.interval import DEFAULT, OFF, Interval, group_of, stream_groups
from mavstack.services.message_request.listing import ListInstances
from mavstack.services.message_request.rates import GetMessageInterval, RateSet, SetMessageInterval
from mavstack.services.message_request.server import InstanceProducer, MessageServer, Producer

__all__ = [
    "DEFAULT",
    "OFF",
    "GetMessageInterval",
    "InstanceProducer",
    "Interval",
    "ListInstances",
    "MessageServer",
    "Producer",
    "RateSet",
    "RequestMessage",
    "SetMessageInterval",
    "group_of",
    "stream_groups",
]
