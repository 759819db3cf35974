"""Parts of an object: made once, on first use; a reboot clears what they cached."""

from __future__ import annotations

from mavstack.node import RemoteComponent
from mavstack.node.parts import Part, clear_caches, parts_of


class Store:
    def __init__(self, owner, size=1):
        self.owner, self.size, self.cached = owner, size, True

    def clear(self):
        self.cached = False


class Whole:
    small = Part(Store, "The small store.")
    large = Part(Store, "The large store.", lambda whole: Store(whole, 9), clear_cache=Store.clear)


class Extended(Whole):
    more = Part(Store, "Another store.")


def test_a_part_is_made_once_with_its_owner():
    whole = Whole()
    assert Whole.small.made(whole) is None
    assert whole.small is whole.small is Whole.small.made(whole)
    assert (whole.small.owner, whole.large.size) == (whole, 9)
    assert Whole().small is not whole.small


def test_a_reboot_clears_the_used_parts_that_cache():
    whole, unused = Extended(), Extended()
    assert whole.small.cached
    assert whole.large.cached
    clear_caches(whole)
    clear_caches(unused)
    assert (whole.small.cached, whole.large.cached) == (True, False)
    assert not vars(unused)


def test_parts_are_listed_with_those_of_the_bases_first():
    assert [part.name for part in parts_of(Extended)] == ["small", "large", "more"]
    assert Extended.more.__doc__ == "Another store."
    assert {"params", "mission", "ftp"} <= {part.name for part in parts_of(RemoteComponent)}
