"""The vehicle that wrote a log."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mavstack.logs.log import Log


def own_system(log: Log) -> int:
    """Return the system id of the vehicle that wrote a log, 0 if the log does not hold it.

    Args:
        log: The log, or a view of it.
    """
    named = int(log.info.get("system", 0) or 0)
    return named or min(log.vehicles, default=0)
