"""Command lines of firmwares."""

from __future__ import annotations

import pytest

from mavstack.errors import InvalidArgumentError
from mavstack.sim.vehicle_types import DEFAULT_HOME
from mavstack.simulators.bodies.surface import BOAT, ROVER
from mavstack.simulators.firmware_command import ardupilot_command, betaflight_command, px4_command


@pytest.fixture
def program(tmp_path):
    (tmp_path / "bin").mkdir()
    (tmp_path / "etc").mkdir()
    file = tmp_path / "bin" / "px4"
    file.write_text("")
    return file


def test_px4(program):
    command = px4_command(str(program), instance=2, speed=5.0)
    etc = str(program.parent.parent / "etc")
    assert command.words == (str(program), "-i", "2", "-d", etc)
    assert command.environment["PX4_SIM_MODEL"] == "none_iris"
    assert command.environment["PX4_SIM_SPEED_FACTOR"] == "5"
    assert (
        px4_command(str(program), model="none_tailsitter").environment["PX4_SIM_MODEL"] == "none_tailsitter"
    )
    with pytest.raises(InvalidArgumentError, match="PX4 has no model of a sub"):
        px4_command(str(program), vehicle="sub")
    boat = px4_command(str(program), vehicle="boat").environment
    assert boat["PX4_PARAM_RO_SPEED_LIM"] == "5"
    assert (boat["PX4_SIM_MODEL"], boat["PX4_SIMULATOR"]) == ("sihsim_rover_ackermann", "mavlink")
    (program.parent.parent / "etc").rmdir()
    with pytest.raises(InvalidArgumentError, match="has no folder etc"):
        px4_command(str(program))


def test_px4_gets_the_parameters_of_its_vehicle_and_body(program):
    cessna = {"physics": "jsbsim:c172x", "parameters": {"FW_R_LIM": 35}}
    plane = px4_command(str(program), vehicle="plane", **cessna).environment
    outputs = [plane[f"PX4_PARAM_PWM_MAIN_FUNC{number}"] for number in range(1, 6)]
    assert outputs == ["202", "203", "101", "204", "0"]
    assert (plane["PX4_PARAM_FW_AIRSPD_TRIM"], plane["PX4_PARAM_FW_R_LIM"]) == ("38", "35")
    own = px4_command(str(program), vehicle="plane", model="own").environment
    assert not [name for name in own if name.startswith("PX4_PARAM_")]


def test_ardupilot(program):
    command = ardupilot_command(
        f"qemu-arm-static {program}", home=DEFAULT_HOME, vehicle="copter", instance=1, speed=4.0, port=9012
    )
    assert command.words[:2] == ("qemu-arm-static", str(program))
    assert command.words[command.words.index("--speedup") :][:2] == ("--speedup", "4")
    assert "--sim-port-out" not in command.words
    assert command.serial_port == 5770
    assert command.files["defaults.parm"] == "SIM_RATE_HZ 400\nFRAME_CLASS 1\nFRAME_TYPE 1\n"
    other = ardupilot_command(str(program), home=DEFAULT_HOME, port=9100, parameters={"SIM_RATE_HZ": 800})
    assert other.words[-2:] == ("--sim-port-out", "9100")
    assert "SIM_RATE_HZ 800\n" in other.files["defaults.parm"]


def test_ardupilot_steers_as_its_body_turns(program):
    """The feed-forward, which applies at 1 m/s, gives the turn rate that was commanded."""
    for vehicle, facts in (("rover", ROVER), ("boat", BOAT)):
        command = ardupilot_command(str(program), home=DEFAULT_HOME, vehicle=vehicle)
        lines = map(str.split, command.files["defaults.parm"].splitlines())
        values = {name: float(value) for name, value in lines}
        share = values["CRUISE_SPEED"] / facts.top_speed
        assert values["CRUISE_THROTTLE"] / 100 == pytest.approx(share, abs=0.01)
        assert values["ATC_STR_RAT_FF"] * facts.turn * (1 + facts.wash) == pytest.approx(1.0, abs=0.05)


def test_a_missing_program_is_reported():
    for command in (betaflight_command, px4_command):
        with pytest.raises(InvalidArgumentError, match="the program '/no/such' is not a file"):
            command("/no/such")
