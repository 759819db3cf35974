"""The observer of a link that is recorded: it parses, and passes on the selected packets."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.cli.watch.observer import Observer

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.wire import Packet


class RecordingObserver(Observer):
    """An observer without counts by message, which take as long as the recording itself."""

    def _pass_on(self, packets: Sequence[Packet], time: float) -> None:
        self.tap(self.selection.select(packets), time)

    def _count(self, packets: Sequence[Packet], now: float) -> Sequence[Packet]:
        return packets
