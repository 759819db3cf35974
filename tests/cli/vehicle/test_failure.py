"""`mav vehicle failure`: what fails, what is asked, and what the vehicle refuses."""

from __future__ import annotations

from tests.cli.harness import COPTER, PX4_COPTER


def test_a_unit_fails_and_works_again(simulate, mav):
    vehicle = simulate(PX4_COPTER).vehicle
    vehicle.parameters.set("SYS_FAILURE_EN", 1)
    result = mav("vehicle", "failure", "motor", "--number", "2", "--yes")
    assert (result.code, result.out) == (0, "vehicle 1: motor 2 fails: off\n")
    assert vehicle.faults.active == {"motor 2": "motor 2 off"}
    result = mav("vehicle", "failure", "motor", "ok", "--number", "2")
    assert (result.code, result.out) == (0, "vehicle 1: motor 2 works again\n")
    assert not vehicle.faults.active


def test_without_a_yes_nothing_fails(simulate, mav):
    vehicle = simulate(PX4_COPTER).vehicle
    vehicle.parameters.set("SYS_FAILURE_EN", 1)
    refused = mav("vehicle", "failure", "gps", "wrong")
    assert refused.code == 2
    assert "add --yes to make a unit fail" in refused.err
    assert not vehicle.faults.active


def test_refusals_are_one_line(simulate, mav):
    simulate(COPTER)
    result = mav("vehicle", "failure", "gps", "--yes")
    assert result.code == 1
    assert "UNSUPPORTED" in result.err
    assert mav("vehicle", "failure", "wing", "--yes").code == 2
    refused = mav("vehicle", "failure", "motor", "--number=-1", "--yes")
    assert refused.code == 2
    assert "--number must be from 0 to 255, got -1" in refused.err
