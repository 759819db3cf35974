from __future__ import annotations

from mavstack.sim.msp.failsafe import Failsafe


def test_a_lost_signal_starts_the_procedure_after_the_guard_time_and_ends_with_the_signal():
    failsafe = Failsafe(1.5, 1.0)
    failsafe.step(0.0, has_signal=False, switched_on=False, armed=True)
    failsafe.step(1.4, has_signal=False, switched_on=False, armed=True)
    assert not failsafe.is_active
    failsafe.step(1.5, has_signal=False, switched_on=False, armed=True)
    assert failsafe.is_active
    failsafe.step(2.0, has_signal=True, switched_on=False, armed=True)
    assert failsafe.is_active
    failsafe.step(3.0, has_signal=True, switched_on=False, armed=True)
    assert not failsafe.is_active


def test_a_short_loss_starts_nothing():
    failsafe = Failsafe(1.5, 1.0)
    failsafe.step(0.0, has_signal=False, switched_on=False, armed=True)
    failsafe.step(1.0, has_signal=True, switched_on=False, armed=True)
    failsafe.step(2.0, has_signal=False, switched_on=False, armed=True)
    assert not failsafe.is_active


def test_the_switch_starts_it_at_once_but_only_while_armed():
    failsafe = Failsafe(1.5, 1.0)
    failsafe.step(0.0, has_signal=True, switched_on=True, armed=False)
    assert not failsafe.is_active
    failsafe.step(0.1, has_signal=True, switched_on=True, armed=True)
    assert failsafe.is_active
