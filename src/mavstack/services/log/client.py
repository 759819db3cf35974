"""The log client."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mavstack.dialects import common
from mavstack.services.addressing import message_ids
from mavstack.services.log.download import DownloadLog
from mavstack.services.log.erase import EraseLogs
from mavstack.services.log.listing import ListLogs
from mavstack.services.operation import Client, Operation

if TYPE_CHECKING:
    from mavstack.services.log.entry import LogEntry


class LogClient(Client):
    """The log client of one component; its operations queue, since a vehicle serves one request at a time."""

    handles = message_ids(common.LogEntry, common.LogData)

    def list_logs(self, now: float, *, timeout: float | None = None) -> ListLogs:
        """List the logs; the result is a tuple of `LogEntry`, by ascending id."""
        return self.begin(ListLogs(timeout=timeout), now)

    def download(
        self, log: LogEntry | int, now: float, *, max_size: int | None = None, timeout: float | None = None
    ) -> DownloadLog:
        """Download a log, given by its entry in the list or by its id; the result is its content.

        It fails with RemoteProtocolError if the log has more than `max_size` bytes; None: twice its listed
        size and 1 MiB.
        """
        return self.begin(DownloadLog(log, max_size=max_size, timeout=timeout), now)

    def erase(self, now: float, *, timeout: float | None = None) -> EraseLogs:
        """Erase all logs."""
        return self.begin(EraseLogs(timeout=timeout), now)

    def conflicts(self, new: Operation[Any], running: Operation[Any]) -> bool:
        return new.parent is None
