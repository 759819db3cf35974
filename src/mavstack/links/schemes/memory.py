"""The record of links within one process."""

from __future__ import annotations

from mavstack.links.scheme import AddressKind, LinkScheme

SCHEMES = (
    LinkScheme(
        name="memory",
        backend="mavstack.links.memory:refuse_url",
        address=AddressKind.NAME,
        example="memory://fleet",
        purpose="Connects nodes of one program; `MemoryNetwork` makes such links.",
    ),
)
