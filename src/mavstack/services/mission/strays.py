"""What may still be on its way from the transfers before: the reason why a new one must wait.

The messages of a transfer name the type of the plan but not the transfer, so a late one passes for one of the
transfer that goes on. Three things keep a plan from being mixed of two:

- A transfer begins at least `SETTLE` after the last message seen of one whose messages it could not tell from
  its own: of the same kind, or of either kind after a failure.
- A vehicle that may still be in an upload that was given up would take our items for those it waits for, if
  our count is lost. So the next upload waits until the vehicle confirms that it stopped, or is quiet for
  `QUIET`, or for `FORGOTTEN` after the last item, when every vehicle has given up.
- After a failure the link may have held messages back (a damaged length lets a receiver wait for bytes that
  are not there): the first message is let pass with all that come with it, and the transfer begins anew.
"""

from __future__ import annotations

from mavstack.dialects import common

ALL = int(common.MavMissionType.ALL)
#: How long the stragglers of a transfer may travel after its last message.
SETTLE = 0.5
#: A vehicle in an upload asks for its item more often than this.
QUIET = 3.0
#: Vehicles give an upload up after 5 (PX4) or 8 seconds without the item they wait for.
FORGOTTEN = 9.0


class Strays:
    """The transfers of one vehicle that are over, and what is left of them."""

    def __init__(self) -> None:
        #: Whether what comes next may have been on its way for long.
        self.held_back = False
        self._seen_at: dict[tuple[int, bool], float] = {}
        self._failed: set[int] = set()
        self._given_up: dict[int, tuple[float, float]] = {}  # by type: when, and when it was last asked for

    def seen(self, plan_type: int, writes: bool, now: float) -> None:
        """A transfer sent something, or heard it."""
        self._seen_at[plan_type, writes] = now

    def ended(self, plan_type: int, *, well: bool) -> None:
        """A transfer ended; one that ended badly may have left anything under way."""
        if well:
            self._failed.discard(plan_type)
        else:
            self._failed.add(plan_type)

    def gave_up(self, plan_type: int, now: float) -> None:
        """The vehicle may still be in an upload."""
        self._given_up[plan_type] = (now, now)

    def asked(self, plan_type: int, now: float) -> None:
        """It asks for an item although no upload goes on: it is in an old one, or a late count began one."""
        begin, _ = self._given_up.get(plan_type, (now, now))
        self._given_up[plan_type] = (begin if now - begin < FORGOTTEN else now, now)

    def stopped(self, plan_type: int) -> None:
        """The vehicle is in no upload of ours, or in a new one."""
        self._given_up.pop(plan_type, None)

    def gone_at(self, plan_type: int, writes: bool) -> float:
        """From when on nothing on its way can be taken for an answer to a new transfer."""
        kinds = (writes, not writes) if plan_type in self._failed else (writes,)
        types = (plan_type, ALL) if plan_type != ALL else {key[0] for key in self._seen_at}
        times = [self._seen_at.get((each, kind), 0.0) + SETTLE for each in types for kind in kinds]
        if writes:
            open_ones = [self._given_up[each] for each in types if each in self._given_up]
            times += [min(begin + FORGOTTEN, asked + QUIET) for begin, asked in open_ones]
        return max(times, default=0.0)
