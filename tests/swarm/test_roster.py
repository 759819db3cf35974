"""The members of a swarm: succession, gaps, returns."""

from __future__ import annotations

import pytest

from mavstack.errors import InvalidArgumentError
from mavstack.swarm.roster import Roster, RosterChange


def seen(*members, at=0.0):
    return dict.fromkeys(members, at)


def test_the_next_by_order_leads():
    roster = Roster([5, 2, 9], timeout=3.0)
    assert roster.update(seen(5, 2, 9), 1.0) == RosterChange()
    assert roster.update({**seen(2, 9, at=4.0), 5: 0.0}, 4.0) == RosterChange(lost=(5,), leader=2)
    assert roster.leader == 2
    assert roster.slots == {2: 0, 9: 1}
    assert roster.update(seen(5, 2, 9, at=5.0), 5.0) == RosterChange(returned=(5,), leader=5)


def test_a_gap_stays_empty_if_wanted_but_the_leader_has_slot_0():
    roster = Roster([1, 2, 3, 4], close_gaps=False)
    roster.update(seen(1, 3, 4), 1.0)
    assert roster.slots == {1: 0, 3: 2, 4: 3}
    roster.update(seen(3, 4), 1.0)
    assert roster.slots == {3: 0, 4: 3}


def test_a_removed_member_does_not_return():
    roster = Roster([1, 2])
    assert roster.remove(1) == RosterChange(lost=(1,), leader=2)
    assert roster.update(seen(1, 2, at=9.0), 9.0) == RosterChange()
    assert roster.present == (2,)


def test_no_member_is_left():
    roster = Roster([1])
    roster.update({}, 9.0)
    assert roster.leader is None
    assert roster.slots == {}


@pytest.mark.parametrize("members", [[], [1, 1]])
def test_members_are_each_once(members):
    with pytest.raises(InvalidArgumentError, match="each once"):
        Roster(members)
