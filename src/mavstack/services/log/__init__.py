"""The log protocol: logs on a vehicle, listed, downloaded and erased."""

from mavstack.services.log.client import LogClient
from mavstack.services.log.download import DownloadLog
from mavstack.services.log.entry import LogEntry
from mavstack.services.log.erase import EraseLogs
from mavstack.services.log.listing import ListLogs, ReadLogEntry
from mavstack.services.log.server import LogsErased, LogServer, LogStore

__all__ = [
    "DownloadLog",
    "EraseLogs",
    "ListLogs",
    "LogClient",
    "LogEntry",
    "LogServer",
    "LogStore",
    "LogsErased",
    "ReadLogEntry",
]
