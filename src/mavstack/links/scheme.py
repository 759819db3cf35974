"""The record of a link scheme: the facts about it that the rest of the program needs before it is opened.

A record is declared once. The parser of URLs, the registry, the notice about reachable ports, the rules for
clients of the router and the station, and the tables of the documentation are derived from it. Records are
small, so that they are read without the backend and its libraries, which are imported when a link is made.

The records of Mavstack are in the modules of `mavstack.links.schemes`, which are found by their place; other
packages have an entry point for each of theirs in the group `mavstack.links`.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Mapping


class AddressKind(Enum):
    """The form of the address in a URL; the value is its name in error texts."""

    HOST = "host"  #: Host and port of a network.
    WEB = "web address"  #: Host, port and path of a network.
    DEVICE = "device"  #: A serial port, whose baud rate may follow its name.
    PATH = "path"  #: A file or a socket of the file system.
    ANY = "address"  #: Text that only the backend understands; it may be empty.
    NAME = "name"  #: A name that only this program knows.


_NETWORK: Final = frozenset({AddressKind.HOST, AddressKind.WEB})


@dataclass(frozen=True, slots=True)
class LinkScheme:
    """The facts about one scheme.

    Attributes:
        name: The scheme, such as `udpin`.
        backend: Module and object, such as `mavstack.links.udp:UdpListener`; the object is called with a
            `LinkURL` and its `Options` and returns a `Link`.
        address: The form of the address.
        example: A valid URL, for error texts and the documentation.
        purpose: One sentence for the documentation.
        listens: The link waits for peers, and has an address on which they reach it.
        is_stream: The bytes of a channel have no boundaries: several packets may share a chunk. False: each
            chunk is a datagram.
        default_port: The port of a URL without one; 0: a URL needs a port.
        aliases: Other names of the scheme, with the options that each implies.
        options: The meaning of each option that only some schemes have, for the documentation.
    """

    name: str
    backend: str
    address: AddressKind
    example: str
    purpose: str
    listens: bool = False
    is_stream: bool = False
    default_port: int = 0
    aliases: Mapping[str, Mapping[str, str]] = field(default_factory=lambda: MappingProxyType({}))
    options: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))

    @property
    def is_network(self) -> bool:
        """True if the peers are reached over a network."""
        return self.address in _NETWORK

    @property
    def is_device(self) -> bool:
        """True if the address is a serial port."""
        return self.address is AddressKind.DEVICE
