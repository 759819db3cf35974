"""Aircraft of JSBSim."""

from __future__ import annotations

import math

import pytest

from mavstack.errors import InvalidArgumentError
from mavstack.rotation import to_euler
from mavstack.sim.vehicle_types import DEFAULT_HOME
from mavstack.simulators.physics import load_physics

pytest.importorskip("jsbsim")
pytestmark = [pytest.mark.interop, pytest.mark.smoke]


def test_a_cessna_stands_on_its_wheels_and_takes_off():
    cessna, _ = load_physics("jsbsim:c172x")
    state = cessna.reset(DEFAULT_HOME, 90.0).checked()
    assert state.specific_force == pytest.approx((0.0, 0.0, -9.8), abs=0.2)
    assert math.degrees(to_euler(state.attitude)[2]) == pytest.approx(90.0, abs=1.0)
    for step in range(8000):
        roll, pitch, yaw = to_euler(state.attitude)
        elevator = 3.0 * (math.radians(6) - pitch) - state.rates[1] if step > 4000 else 0.0
        rudder = 2.0 * (math.pi / 2 - yaw) - state.rates[2]
        state = cessna.step((-1.0 * roll - state.rates[0], elevator, 1.0, rudder), 0.005)
    state.checked()
    assert state.position[2] < -3.0
    assert state.airspeed > 25.0


def test_an_unknown_aircraft_is_reported(capfd):
    with pytest.raises(InvalidArgumentError, match="JSBSim has no aircraft 'zeppelin'"):
        load_physics("jsbsim:zeppelin")
    assert capfd.readouterr().out == ""


@pytest.mark.parametrize("aircraft", ["c172x", "c310", "f16"])
def test_an_aircraft_with_a_log_of_its_model_writes_no_files(aircraft, tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    body, _ = load_physics(f"jsbsim:{aircraft}")
    for _ in range(2):  # at the second reset JSBSim opens the logs again
        body.reset(DEFAULT_HOME, 0.0)
        body.step((0.0, 0.0, 0.5, 0.0), 0.02)
    assert list(tmp_path.iterdir()) == []
    assert capfd.readouterr() == ("", "")
