"""The filter for reordered packets."""

from __future__ import annotations

from mavstack.services.parameters.reorder_filter import ReorderFilter


def test_copies_and_reordered_packets_are_reported_from_new_ones() -> None:
    newest = ReorderFilter()
    assert not newest.is_reordered(250, 0.0)
    assert newest.is_reordered(250, 0.1)
    assert newest.is_reordered(240, 0.1)
    assert not newest.is_reordered(3, 0.2)
    assert newest.is_reordered(255, 0.3)
    assert not newest.is_reordered(200, 0.3)


def test_after_a_while_everything_is_new() -> None:
    newest = ReorderFilter()
    assert not newest.is_reordered(100, 0.0)
    assert newest.is_reordered(99, 0.4)
    assert not newest.is_reordered(99, 0.6)
