"""Links: byte transports behind URLs, such as UDP, TCP, TLS, WebSocket, serial ports and files."""

from mavstack.links.base import Link
from mavstack.links.channel import Channel, Counters, Request
from mavstack.links.events import BytesReceived, ChannelClosed, ChannelOpened, LinkDown, LinkEvent
from mavstack.links.impaired import impair
from mavstack.links.impairment import Flow, Impairment
from mavstack.links.memory import MemoryNetwork, memory_pair
from mavstack.links.registry import open_link
from mavstack.links.settings import LinkSettings
from mavstack.links.url import LinkURL, parse_url

__all__ = [
    "BytesReceived",
    "Channel",
    "ChannelClosed",
    "ChannelOpened",
    "Counters",
    "Flow",
    "Impairment",
    "Link",
    "LinkDown",
    "LinkEvent",
    "LinkSettings",
    "LinkURL",
    "MemoryNetwork",
    "Request",
    "impair",
    "memory_pair",
    "open_link",
    "parse_url",
]
