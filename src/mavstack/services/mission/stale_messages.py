"""Stale messages of earlier transfers: the reason why a new transfer must wait.

The messages of a transfer name the plan type but not the transfer, so a late one looks like one of the
running transfer. Three rules prevent a plan mixed from two:

- A transfer begins at least `SETTLE` seconds after the last message of any transfer whose messages it could
  not tell from its own: one of the same direction, or of either direction after a failure.
- A vehicle that is still in an abandoned upload would accept the new items for the old ones, if the new count
  is lost. So the next upload waits until the vehicle confirms that it stopped, or is silent for `QUIET`
  seconds, or until `UPLOAD_EXPIRES_AFTER` seconds after the last item, when every vehicle has given up.
- After a failure the link may have held messages back (a damaged length lets a receiver wait for bytes that
  do not exist): the first message is ignored with all that arrive with it, and the transfer restarts.
"""

from __future__ import annotations

from mavstack.dialects import common

ALL = int(common.MavMissionType.ALL)
#: Seconds after the last message of a transfer in which further messages of it may arrive.
SETTLE = 0.5
#: A vehicle that receives an upload repeats its request within this time, in seconds.
QUIET = 3.0
#: Seconds after which an upload has ended on every vehicle: without the requested item, PX4 ends it after 5
#: s, others after 8 s.
UPLOAD_EXPIRES_AFTER = 9.0


class StaleMessages:
    """The ended transfers to one vehicle, whose messages may still arrive."""

    def __init__(self) -> None:
        #: True after a transfer that was aborted (`clean_up`), because the link may have held back its
        #: messages. The next transfer then ignores the first message that arrives, and restarts `SETTLE`
        #: seconds later.
        self.held_back = False
        self._seen_at: dict[tuple[int, bool], float] = {}
        self._failed: set[int] = set()
        #: By plan type: the time when an upload was abandoned, and the time of the last request for one of
        #: its items.
        self._abandoned: dict[int, tuple[float, float]] = {}

    def record(self, plan_type: int, writes: bool, now: float) -> None:
        """Record a message of a transfer."""
        self._seen_at[plan_type, writes] = now

    def ended(self, plan_type: int, *, success: bool) -> None:
        """Record the end of a transfer; after a failure, any of its messages may still arrive."""
        if success:
            self._failed.discard(plan_type)
        else:
            self._failed.add(plan_type)

    def upload_abandoned(self, plan_type: int, now: float) -> None:
        """Record an abandoned upload, in which the vehicle may still be."""
        self._abandoned[plan_type] = (now, now)

    def item_requested(self, plan_type: int, now: float) -> None:
        """Record a request without an upload: the vehicle is in an old one, or a late count began one."""
        begin, _ = self._abandoned.get(plan_type, (now, now))
        self._abandoned[plan_type] = (begin if now - begin < UPLOAD_EXPIRES_AFTER else now, now)

    def upload_stopped(self, plan_type: int) -> None:
        """Record that the vehicle is in no abandoned upload any more."""
        self._abandoned.pop(plan_type, None)

    def earliest_start(self, plan_type: int, writes: bool) -> float:
        """Return when a new transfer may begin without receiving stale messages."""
        kinds = (writes, not writes) if plan_type in self._failed else (writes,)
        types = (plan_type, ALL) if plan_type != ALL else {key[0] for key in self._seen_at}
        times = [self._seen_at.get((each, kind), 0.0) + SETTLE for each in types for kind in kinds]
        if writes:
            abandoned = [self._abandoned[each] for each in types if each in self._abandoned]
            times += [min(begin + UPLOAD_EXPIRES_AFTER, requested + QUIET) for begin, requested in abandoned]
        return max(times, default=0.0)
