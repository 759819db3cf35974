"""The record of links over Iridium modems."""

from __future__ import annotations

from mavstack.links.scheme import AddressKind, LinkScheme
from mavstack.links.schemes import serial

(_SERIAL,) = serial.SCHEMES

SCHEMES = (
    LinkScheme(
        name="sbd+serial",
        backend="mavstack.links.sbd:SbdLink",
        address=AddressKind.DEVICE,
        example="sbd+serial:///dev/ttyUSB0?baud=19200&interval=60",
        purpose="Sends packets as short burst data of an Iridium modem; needs the extra `serial`.",
        options={
            **_SERIAL.options,
            "interval": "least time between two sessions, which cost money",
            "poll": "time after which the mailbox is checked without a ring alert",
        },
    ),
)
