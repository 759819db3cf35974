"""Barriers open when all are ready, and break after their timeout."""

from __future__ import annotations

from mavstack.swarm.barrier import Barrier, BarrierState


def test_a_barrier_opens_when_all_arrived():
    barrier = Barrier([3, 1, 2], timeout=10.0, now=0.0)
    barrier.arrive(1)
    barrier.arrive(7)
    assert barrier.state(1.0) is BarrierState.WAITING
    assert barrier.missing == (2, 3)
    barrier.arrive(2)
    barrier.arrive(3)
    assert barrier.state(99.0) is BarrierState.OPEN


def test_a_barrier_breaks_after_its_timeout():
    barrier = Barrier([1], timeout=10.0, now=5.0)
    assert barrier.state(14.9) is BarrierState.WAITING
    assert barrier.state(15.0) is BarrierState.BROKEN
    assert Barrier([1], timeout=None, now=0.0).state(1e9) is BarrierState.WAITING
