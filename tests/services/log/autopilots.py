"""Log servers as autopilots behave, for the client's tests."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services import Outgoing, Service
from mavstack.services.addressing import message_ids

if TYPE_CHECKING:
    from tests.services.log.store import MemoryStore

CHUNK = 90


class _Autopilot(Service):
    handles = message_ids(common.LogRequestList, common.LogRequestData, common.LogRequestEnd, common.LogErase)

    def __init__(self, local, store: MemoryStore) -> None:
        super().__init__(local)
        self.store = store
        self.sending: tuple[int, int, int] | None = None
        self.listing: list = []
        self.ends = 0
        self.requests = 0

    def bulk_messages(self, now, has_room):
        while (self.sending or self.listing) and has_room(self.local.__class__(255, 190)):
            yield Outgoing(self.listing.pop(0) if self.listing else self.chunk())

    def chunk(self) -> common.LogData:
        number, offset, end = self.sending
        content = self.store.read(number, offset, max(min(CHUNK, end - offset), 0))
        self.sending = (number, offset + CHUNK, end)
        if len(content) < CHUNK or offset + CHUNK >= end:
            self.sending = None
        return common.LogData(id=number, ofs=offset, count=len(content), data=content)

    def entries(self, first: int, last: int) -> list[common.LogEntry]:
        logs = self.store.logs()
        return [
            common.LogEntry(
                id=log.id, num_logs=len(logs), last_log_num=last, size=log.size, time_utc=log.time_utc
            )
            for log in logs
            if first <= log.id <= last
        ] or [common.LogEntry()] * (not logs)


class ArduPilotLogs(_Autopilot):
    """Ids from 1; what is asked for while it is busy is dropped; an id that is not there floods the list."""

    def receive(self, packet, now: float) -> None:
        busy = bool(self.sending or self.listing)
        match packet.message:
            case common.LogRequestEnd():
                self.ends, self.sending, self.listing = self.ends + 1, None, []
            case common.LogRequestList(start=first, end=last) if not busy:
                highest = len(self.store.contents)
                assert highest == 0 or max(first, 1) <= min(last, highest), "an endless list"
                self.listing = self.entries(max(first, 1), min(last, highest))
            case common.LogRequestData(id=number, ofs=offset, count=count) if not busy:
                self.requests += 1
                size = len(self.store.contents.get(number, b""))
                self.sending = (
                    (number, offset, min(offset + count, size)) if number in self.store.contents else None
                )


class PX4Logs(_Autopilot):
    """Ids from 0; a log must have been listed; a new request ends the old; behind the end it is silent."""

    listed = False

    def receive(self, packet, now: float) -> None:
        match packet.message:
            case common.LogRequestEnd():
                self.ends, self.sending, self.listing, self.listed = self.ends + 1, None, [], False
            case common.LogRequestList(start=first):
                self.listed, self.sending = True, None
                self.listing = self.entries(first, 0xFFFF) if self.store.contents else []
            case common.LogRequestData(id=number, ofs=offset, count=count) if self.listed:
                self.requests += 1
                size = len(self.store.contents.get(number, b""))
                self.listing = []
                self.sending = (number, offset, min(offset + count, size)) if offset < size else None
