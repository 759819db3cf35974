"""`mav vehicle transponder`: what it shows, sets and refuses."""

from __future__ import annotations

import pytest

from mavstack.cli.vehicle.transponder import describe
from mavstack.vehicle.transponder import TransponderStatus
from tests.cli.harness import COPTER


def test_it_is_set_and_shown(simulate, mav):
    simulate(COPTER).vehicle.parameters.set("ADSB_TYPE", 3)
    state = "vehicle 1: squawk 7000, flight id LX1, transmits, ident, on the ground\n"
    result = mav("vehicle", "transponder", "7000", "--flight-id", "LX1", "--ident")
    assert (result.code, result.out, result.err) == (0, state, "")
    assert mav("vehicle", "transponder").out == state


@pytest.mark.parametrize(
    ("option", "state"), [("--standby", "standby"), ("--no-altitude", "transmits, without altitude")]
)
def test_options(simulate, mav, option, state):
    simulate(COPTER).vehicle.parameters.set("ADSB_TYPE", 3)
    result = mav("vehicle", "transponder", "0021", option)
    assert result.out == f"vehicle 1: squawk 0021, {state}, on the ground\n"


@pytest.mark.parametrize(
    ("words", "problem"),
    [(("--standby",), "a setting needs a squawk"), (("7800",), "a squawk must be four digits from 0 to 7")],
)
def test_wrong_settings_are_not_sent(simulate, mav, words, problem):
    harness = simulate(COPTER)
    harness.vehicle.parameters.set("ADSB_TYPE", 3)
    result = mav("vehicle", "transponder", *words)
    assert result.code == 2
    assert problem in result.err
    assert mav("vehicle", "transponder").out == "vehicle 1: squawk 1200, standby, on the ground\n"


def test_all_parts_of_a_state():
    faulty = TransponderStatus("0021", "", True, False, False, False, 35, ("GPS_NO_POS", "MAINT_REQ"))
    assert describe(faulty) == "squawk 0021, transmits, without altitude, faults: GPS_NO_POS MAINT_REQ"


def test_the_identity_in_a_transponder_that_speaks_mavlink(simulate, mav):
    harness = simulate(COPTER)
    harness.vehicle.has_transponder = True
    harness.vehicle.reboot()
    result = mav("vehicle", "transponder", "--registration", "N8644B", "--flight-id", "LX1")
    assert (result.code, result.out) == (0, "vehicle 1: registration N8644B, flight id LX1\n")
    mav("vehicle", "transponder", "--registration", "")
    assert mav("vehicle", "transponder", "--identity").out == (
        "vehicle 1: registration not set, flight id LX1\n"
    )
    refused = mav("vehicle", "transponder", "7000", "--registration", "N1")
    assert refused.code == 2
    assert "leave out squawk" in refused.err
