"""The clock of DataFlash logs."""

from __future__ import annotations

from mavstack.logs.dataflash.clock import span

DAY = 86_400_000_000


def test_times_of_damaged_records_are_no_beginning_and_no_end():
    assert span([5, 10, -3], [100, 120, 2**62]) == (5, 120)
    assert span([5, 10, 7], [100, 120, 110 + 2 * DAY]) == (5, 120)
    assert span([5, 10], [100, 120 + DAY // 2]) == (5, 120 + DAY // 2), "a table of rare records ends later"
    assert span([], []) is None
    assert span([-1], [-1]) is None
