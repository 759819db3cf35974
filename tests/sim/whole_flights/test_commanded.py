"""Flights without a mission, by commands, setpoints and sticks over MAVLink: one test per script."""

from __future__ import annotations

import pytest

import tests.sim.whole_flights.scripts  # noqa: F401 (registers the scripts)
from tests.sim.whole_flights.conftest import fly_once
from tests.sim.whole_flights.script_runner import SCRIPTS, fly_scripts

pytestmark = pytest.mark.nightly


@pytest.fixture(scope="session")
def outcomes(tmp_path_factory, worker):
    return fly_once(tmp_path_factory, worker, "commanded", fly_scripts)


@pytest.mark.parametrize("name", [each.name for each in SCRIPTS])
def test_commanded(outcomes, name: str) -> None:
    if outcomes[name]:
        pytest.fail(outcomes[name], pytrace=False)
