"""The record of replayed files."""

from __future__ import annotations

from mavstack.links.scheme import AddressKind, LinkScheme

SCHEMES = (
    LinkScheme(
        name="file",
        backend="mavstack.links.file:FileLink",
        address=AddressKind.PATH,
        example="file://flight.tlog?speed=2",
        purpose="Replays a tlog or a file of raw packets.",
        options={"speed": "1: as recorded, 10: ten times as fast, max: at once"},
    ),
)
