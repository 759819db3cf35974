"""The observer of a link that is recorded: it parses, and passes on the selected packets."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.cli.watch.observer import Observer, Selection
from mavstack.security.timestamps import time_if_set

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.logs.recorder import Recorder
    from mavstack.wire import Packet


class RecordingObserver(Observer):
    """An observer without counts by message, which take as long as the recording itself.

    If all packets are recorded, the recorder parses them itself.
    """

    _recorder: Recorder | None = None

    def record_to(self, recorder: Recorder) -> None:
        """Pass the selected packets to a recorder."""
        super().record_to(recorder)
        if self.selection == Selection():
            self._recorder = recorder

    def receive(
        self,
        channel: str,
        data: bytes,
        now: float,
        duration: float | None = None,
        *,
        time: float | None = None,
    ) -> Sequence[Packet]:
        """Parse and record data; return the selected packets, or none if all are recorded."""
        if self._recorder is None:
            return super().receive(channel, data, now, duration, time=time)
        parser = self.channels[channel]
        self.received += self._recorder.feed(parser, data, time or 0.0, time_if_set(time or 0.0))
        return ()

    def _pass_on(self, packets: Sequence[Packet], time: float) -> None:
        super()._pass_on(self.selection.select(packets), time)

    def _count(self, packets: Sequence[Packet], now: float) -> Sequence[Packet]:
        return packets
