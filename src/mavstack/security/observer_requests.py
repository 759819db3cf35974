"""Requests of clients that observe: each one is passed to a vehicle once for all of them, and few per second.

A vehicle answers the request of an observer by work: it sends its parameters, a message, an echo. Its answers
go to all observers, so a request that one of them sent a moment ago need not be sent again, and requests of
observers must not delay those of pilots. `ObserverRequests` is shared by the clients of one link or station.

Requests that change the streams of a vehicle (SET_MESSAGE_INTERVAL, REQUEST_DATA_STREAM) and requests of the
mission protocol, whose transfers delay those of a pilot, are not for observers at all (see `role_tables`).

The module has no clock: the caller passes the time.
"""

from __future__ import annotations

from collections import OrderedDict
from typing import Any, Final

from mavstack.dialects import common

#: Seconds after a request in which an equal one is not forwarded; longer for requests of all parameters.
REPEAT_INTERVAL: Final = 5.0
LIST_INTERVAL: Final = 30.0
#: Maximum number of requests of all observers together per second, and at once after a pause.
MAX_RATE: Final = 4.0
MAX_BURST: Final = 16.0
#: Maximum number of requests that are kept.
MAX_REQUESTS: Final = 1024
#: Fields in which two requests of one message id differ if they are not equal.
_FIELDS: Final = ("target_system", "target_component", "param_id", "param_index", "command", "param1")
_LISTS: Final = (common.ParamRequestList, common.ParamExtRequestList)


class ObserverRequests:
    """The requests of all observers of one link or station."""

    def __init__(self) -> None:
        self._passed: OrderedDict[tuple[Any, ...], float] = OrderedDict()
        self._allowance = MAX_BURST
        self._updated = 0.0
        #: Number of requests that were not forwarded.
        self.held_back = 0

    def passes(self, message: object, now: float) -> bool:
        """Return whether a message of an observer is passed to the vehicles.

        Args:
            message: A message that the role of observers allows.
            now: The time in seconds.

        Returns:
            True for a heartbeat, and for a request that no observer sent a moment ago, if few were passed.
        """
        if isinstance(message, common.Heartbeat):
            return True
        key = _key(message)
        elapsed, self._updated = max(0.0, now - self._updated), now
        self._allowance = min(MAX_BURST, self._allowance + elapsed * MAX_RATE)
        if self._allowance < 1 or self._passed.get(key, now) > now:
            self.held_back += 1
            return False
        self._allowance -= 1
        self._passed[key] = now + (LIST_INTERVAL if isinstance(message, _LISTS) else REPEAT_INTERVAL)
        self._passed.move_to_end(key)
        if len(self._passed) > MAX_REQUESTS:
            self._passed.popitem(last=False)
        return True


def _key(message: object) -> tuple[Any, ...]:
    """Return the message, the target and the subject of a request."""
    if isinstance(message, common.Ping | common.Timesync):
        # ignore their number and time, which differ in each message
        return (type(message), message.target_system)
    return (type(message), *(getattr(message, field, None) for field in _FIELDS))
