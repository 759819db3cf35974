"""The record of links to fleets on Zenoh; an entry point of the group `mavstack.links`."""

from __future__ import annotations

from types import MappingProxyType
from typing import Final

from mavstack.links.scheme import AddressKind, LinkScheme

ZENOH: Final = LinkScheme(
    name="zenoh",
    backend="mavstack.bridges.zenoh.link:ZenohLink",
    address=AddressKind.WEB,
    example="zenoh://127.0.0.1:7447/mavstack",
    purpose="Connects to a Zenoh router; each vehicle of a fleet is a channel. The path is the prefix.",
    default_port=7447,
    options=MappingProxyType(
        {
            "vehicle": "name of the only vehicle; without it all vehicles of the fleet are channels",
            "timeout": "time limit of the first connection",
            "ca": "file with the authority of the router's certificate; then the connection is TLS",
            "cert": "file with the own certificate, which the router knows",
            "key": "file with the private key of `cert`",
        }
    ),
)
