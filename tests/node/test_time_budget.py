"""The timeout of a call of several requests."""

from __future__ import annotations

from mavstack.node.time_budget import MIN_REMAINING, TimeBudget


def test_each_request_gets_the_remaining_seconds() -> None:
    now = 100.0
    budget = TimeBudget(10.0, lambda: now)
    assert (budget.remaining(), budget.remaining(3.0), budget.remaining(30.0)) == (10.0, 3.0, 10.0)
    now += 8.0
    assert (budget.remaining(), budget.remaining(3.0)) == (2.0, 2.0)
    now += 8.0
    assert (budget.remaining(), budget.remaining(3.0)) == (MIN_REMAINING, MIN_REMAINING)


def test_without_a_timeout_only_the_maximum_limits_a_request() -> None:
    budget = TimeBudget(None, lambda: 100.0)
    assert (budget.remaining(), budget.remaining(3.0)) == (None, 3.0)
