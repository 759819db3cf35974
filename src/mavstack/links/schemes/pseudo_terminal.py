"""The record of pseudo terminals."""

from __future__ import annotations

from mavstack.links.scheme import AddressKind, LinkScheme

SCHEMES = (
    LinkScheme(
        name="pty",
        backend="mavstack.links.pseudo_terminal:PseudoTerminalLink",
        address=AddressKind.PATH,
        example="pty:///tmp/ttyDrone",
        purpose="Makes a serial port for other programs of this machine; not on Windows.",
        is_stream=True,
    ),
)
