"""The record of serial links."""

from __future__ import annotations

from mavstack.links.scheme import AddressKind, LinkScheme
from mavstack.links.scheme_options import RECONNECTION

SCHEMES = (
    LinkScheme(
        name="serial",
        backend="mavstack.links.serial:SerialLink",
        address=AddressKind.DEVICE,
        example="serial:///dev/ttyACM0?baud=57600",
        purpose="Opens a serial port; needs the extra `serial`.",
        is_stream=True,
        aliases={"serial_flowcontrol": {"flow": "rtscts"}},
        options={
            **RECONNECTION,
            "baud": "baud rate",
            "flow": "flow control",
            "threads": "read and write in threads instead of by the event loop",
        },
    ),
)
