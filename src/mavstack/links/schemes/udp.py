"""The records of UDP links."""

from __future__ import annotations

from mavstack.links.scheme import AddressKind, LinkScheme
from mavstack.links.scheme_options import PEERS

_SOCKET = {"socket_buffer": "size of the operating system's socket buffers"}

SCHEMES = (
    LinkScheme(
        name="udpin",
        backend="mavstack.links.udp:UdpListener",
        address=AddressKind.HOST,
        example="udpin://0.0.0.0:14550",
        purpose="Listens on a UDP port; each sender is a channel. A multicast group as host is joined.",
        listens=True,
        aliases={"udp": {}},
        options={
            **PEERS,
            **_SOCKET,
            "idle": "a peer that is silent for this long is closed; 0: never",
            "trust_senders": "`no` (default in a router): a new peer gets three times what it sent "
            "until it answers",
        },
    ),
    LinkScheme(
        name="udpout",
        backend="mavstack.links.udp_sender:UdpSender",
        address=AddressKind.HOST,
        example="udpout://192.168.1.10:14550",
        purpose="Sends to one UDP peer; broadcast and multicast addresses work.",
        aliases={"udpbcast": {}},
        options=_SOCKET,
    ),
)
