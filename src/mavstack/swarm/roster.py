"""The members of a swarm: who leads, who was lost, who has which slot.

The first member that is present leads. If the leader is lost, the next by order leads, so that all programs
that know the order agree without a message. A lost member's slot is closed up by the others, or stays empty
(`close_gaps`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

#: Seconds without a position report after which a member is lost.
MEMBER_TIMEOUT = 3.0


@dataclass(frozen=True, slots=True)
class RosterChange:
    """A change of the roster.

    Attributes:
        lost: The members that were lost.
        returned: The members that came back.
        leader: The new leader if it changed, else None.
    """

    lost: tuple[int, ...] = ()
    returned: tuple[int, ...] = ()
    leader: int | None = None


_NO_CHANGE: Final = RosterChange()


class Roster:
    """The members in their order.

    Args:
        members: The system ids, the leader first.
        timeout: Seconds without a position after which a member is lost.
        close_gaps: True: the slot of a lost member is taken by the next one; False: it stays empty.
    """

    def __init__(
        self, members: Iterable[int], *, timeout: float = MEMBER_TIMEOUT, close_gaps: bool = True
    ) -> None:
        self.members = tuple(members)
        if not self.members or len(set(self.members)) != len(self.members):
            raise InvalidArgumentError("a swarm must have members, each once")
        self._timeout = timeout
        self._close_gaps = close_gaps
        self._lost: set[int] = set()
        self._gone: set[int] = set()

    @property
    def absent(self) -> set[int]:
        """The members that were lost or removed."""
        return self._lost | self._gone

    @property
    def present(self) -> tuple[int, ...]:
        """The members that are present, in order."""
        return tuple(self._present())

    @property
    def leader(self) -> int | None:
        """The first member that is present; None if there is none."""
        return next(self._present(), None)

    @property
    def slots(self) -> dict[int, int]:
        """The slot of each present member."""
        if self._close_gaps:
            return {member: slot for slot, member in enumerate(self.present)}
        places = {member: slot for slot, member in enumerate(self.members)}
        leader = self.leader
        return {member: 0 if member == leader else places[member] for member in self.present}

    def remove(self, member: int) -> RosterChange:
        """Remove a member permanently: it landed, or another program took control of it."""
        before = self.leader
        self._gone.add(member)
        return self._change((member,), (), before)

    def update(self, last_seen: dict[int, float], now: float) -> RosterChange:
        """Take the times of the last positions.

        Args:
            last_seen: Time of the last position of each member, in seconds.
            now: Seconds.

        Returns:
            The change since the last call.
        """
        late = {each for each in self.members if now - last_seen.get(each, -1e9) > self._timeout} - self._gone
        if late == self._lost:
            return _NO_CHANGE
        before = self.leader
        lost = tuple(each for each in self.members if each in late - self._lost)
        returned = tuple(each for each in self.members if each in self._lost - late)
        self._lost = late
        return self._change(lost, returned, before)

    def _change(self, lost: tuple[int, ...], returned: tuple[int, ...], before: int | None) -> RosterChange:
        return RosterChange(lost, returned, self.leader if self.leader != before else None)

    def _present(self) -> Iterator[int]:
        absent = self.absent
        return (member for member in self.members if member not in absent)
