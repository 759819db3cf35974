"""The rows of the list of sources: each link, its channels if there are several, and its components."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mavstack.cli.watch.observer import SourceCounts
    from mavstack.cli.watch.snapshot import ComponentRow, MessageRow, Snapshot


@dataclass(frozen=True, slots=True)
class SourceRow:
    """A link, one of its channels, or one of its components.

    Channels have no rate: packets are counted by component.
    """

    label: str
    name: str
    counts: SourceCounts
    #: Packets per second; None: not known.
    rate: float | None = None
    #: Received bytes that are not part of a valid packet; None for a component.
    bad_bytes: int | None = None
    #: State and type of a component, or the problem of a link.
    detail: str = ""
    system: int | None = None
    component: int | None = None
    channel: str = ""

    @property
    def key(self) -> tuple[str, str, int | None, int | None]:
        """The identity of the row."""
        return self.label, self.channel, self.system, self.component

    @property
    def address(self) -> str:
        """The letter of the link, and system and component; in words for a link."""
        if self.is_component:
            return f"{self.label} {self.system}/{self.component}".lstrip()
        return f"link {self.label}" if self.label else "this link"

    @property
    def is_component(self) -> bool:
        """True for a component, False for a link or a channel."""
        return self.system is not None

    def includes(self, message: MessageRow) -> bool:
        """Return whether a message comes from this source; a channel includes all messages of its link."""
        if self.label != message.label:
            return False
        return not self.is_component or (self.system, self.component) == (message.system, message.component)


def source_rows(label: str, title: str, snapshot: Snapshot) -> list[SourceRow]:
    """Return the rows of one link."""
    totals = snapshot.totals
    name = f"{label} {title}".lstrip()
    link = SourceRow(
        label, name, totals.all_sources, snapshot.rate.packets, totals.bad_bytes, detail=snapshot.note
    )
    channels = [
        SourceRow(label, each.name, each.counts, None, each.bad_bytes, channel=each.name)
        for each in snapshot.channels
    ]
    components = sorted(snapshot.components, key=lambda row: (not row.identity.autopilot, row.system))
    return [
        link,
        *(channels if len(channels) > 1 else []),
        *(_component_row(label, row, snapshot) for row in components),
    ]


def _component_row(label: str, row: ComponentRow, snapshot: Snapshot) -> SourceRow:
    address = row.system, row.component
    rate = sum(each.rate.packets for each in snapshot.messages if (each.system, each.component) == address)
    words = (row.state, row.identity.type_name, row.identity.autopilot)
    return SourceRow(
        label,
        f"{row.system}/{row.component}",
        row.counts,
        rate,
        detail=" ".join(word for word in words if word),
        system=row.system,
        component=row.component,
    )
