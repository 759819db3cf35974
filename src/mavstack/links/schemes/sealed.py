"""The records of sealed links: the facts of the link behind the `+`, except that it carries datagrams."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.links.scheme import LinkScheme
from mavstack.links.schemes import serial, tcp, udp

if TYPE_CHECKING:
    from collections.abc import Mapping

#: The prefix of the schemes of sealed links; the scheme of the inner link follows it.
SEALED: Final = "sealed+"

#: Options of the keys and of joined packets, which relay links share.
SEAL_OPTIONS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "cipher": "the cipher, equal at both ends",
        "hybrid": "add ML-KEM-768 to the key exchange, at both ends",
        "mtu": "bytes of a datagram to which waiting packets are joined",
        "peer": "public keys of the peers: digits, or a file with a line for each; "
        "an end that connects has one",
        "private_key": "file or name of the own key for sealed links",
        "secret": "the shared key itself, as 64 hexadecimal digits, for URLs that are copied",
        "shared_key": "file or name of a signing key that both ends have, from which the key is derived",
    }
)


def _sealed(carrier: LinkScheme, example: str, purpose: str, alias: str = "") -> LinkScheme:
    return LinkScheme(
        name=f"{SEALED}{carrier.name}",
        backend="mavstack.links.sealed:SealedLink",
        address=carrier.address,
        example=f"{SEALED}{carrier.name}://{example}",
        purpose=purpose,
        listens=carrier.listens,
        aliases={f"{SEALED}{alias}": {}} if alias else {},
        options={**carrier.options, **SEAL_OPTIONS},
    )


_UDPIN, _UDPOUT = udp.SCHEMES
_TCPIN, _TCPOUT = tcp.SCHEMES
(_SERIAL,) = serial.SCHEMES

SCHEMES = (
    _sealed(
        _UDPIN,
        "0.0.0.0:14560?shared_key=fleet",
        "Answers sealed UDP peers; needs the extra `secure`.",
        "udp",
    ),
    _sealed(_UDPOUT, "ground.example:14560?shared_key=fleet", "Connects to a sealed UDP link."),
    _sealed(_TCPIN, "0.0.0.0:5762?private_key=ground&peer=peers.txt", "Accepts sealed TCP connections."),
    _sealed(
        _TCPOUT,
        "ground.example:5762?private_key=boat&peer=ground.pub",
        "Connects to a sealed TCP link; `sealed+tcp` is the same.",
        "tcp",
    ),
    _sealed(
        _SERIAL,
        "/dev/ttyUSB0?baud=57600&shared_key=fleet",
        "Seals a serial port; the URL is the same at both ends.",
    ),
)
