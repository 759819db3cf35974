"""The records of links to flight controllers that speak MSP; entry points of the group `mavstack.links`."""

from __future__ import annotations

from typing import Final

from mavstack.links.scheme import AddressKind, LinkScheme

_BACKEND: Final = "mavstack.bridges.msp.link:open_link"

MSP_SERIAL: Final = LinkScheme(
    name="msp+serial",
    backend=_BACKEND,
    address=AddressKind.DEVICE,
    example="msp+serial:///dev/ttyACM0",
    purpose="Opens the serial port of a Betaflight or iNav flight controller.",
)
MSP_TCP: Final = LinkScheme(
    name="msp+tcp",
    backend=_BACKEND,
    address=AddressKind.HOST,
    example="msp+tcp://127.0.0.1:5761",
    purpose="Connects to a Betaflight or iNav flight controller over TCP.",
)
