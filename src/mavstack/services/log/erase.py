"""The erasure of all logs.

LOG_ERASE is not answered, and an armed autopilot ignores it silently. So the list before is compared with the
list after: all logs of the former must be gone. A new log may already exist.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mavstack.dialects import common
from mavstack.errors import LogTimeout, RemoteDenied
from mavstack.services.log.listing import ListLogs, LogOperation
from mavstack.services.pause import Pause
from mavstack.services.procedure import Procedure

if TYPE_CHECKING:
    from collections.abc import Generator

    from mavstack.services.log.entry import LogEntry
    from mavstack.services.operation import Operation

ATTEMPTS = 5
#: Seconds to wait after the first LOG_ERASE; doubled for each attempt.
INITIAL_WAIT = 0.5


class EraseLogs(Procedure[None]):
    """The erasure of all logs of the target."""

    timeout_error = LogTimeout

    def __init__(self, *, timeout: float | None = None) -> None:
        super().__init__("erasing all logs of", timeout=timeout, idle_timeout=120.0)

    def steps(self) -> Generator[Operation[Any], Any, None]:
        """List the logs, then erase and list until they are gone."""
        before: tuple[LogEntry, ...] = yield ListLogs()
        left = set(before)
        for attempt in range(ATTEMPTS):
            if not left:
                return
            yield _SendErase()
            yield Pause(INITIAL_WAIT * 2**attempt)
            after: tuple[LogEntry, ...] = yield ListLogs()
            left = set(before) & set(after)
        if left:
            answer = f"{len(left)} logs remain"
            raise RemoteDenied(self.description, str(self.target), attempts=ATTEMPTS, answer=answer)


class _SendErase(LogOperation[None]):
    """The message LOG_ERASE, which has no answer."""

    def __init__(self) -> None:
        super().__init__("sending LOG_ERASE to")

    def start(self, now: float) -> None:
        to = self.target
        self.send(common.LogErase(target_system=to.system, target_component=to.component))
        self.finish(None)
