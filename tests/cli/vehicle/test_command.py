"""`mav vehicle`: each action on both firmwares, exit codes, one vehicle and several."""

from __future__ import annotations

import json
import re
import shlex
from types import SimpleNamespace

import pytest

from mavstack.cli.vehicle.command import EXAMPLES
from mavstack.errors import SystemIdConflictError
from mavstack.node import Node
from tests.cli.harness import COPTER, PX4_COPTER
from tests.vehicle.world import ARDUPILOT, VehicleType, kind_name

ROVER = (VehicleType.ROVER, ARDUPILOT)
BOTH = [COPTER, PX4_COPTER]
#: Actions of PX4, of VTOLs, of equipment that has to be set up, and of vehicles on the ground.
NOT_OF_A_COPTER = {"actuator", "transition", "gripper", "winch", "motor-test", "calibrate", "events"}
#: Actions that ask before they begin.
CONFIRMED = {"terminate"}


@pytest.mark.nightly
@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("kind", BOTH, ids=kind_name)
def test_a_flight(simulate, mav, kind):
    harness = simulate(kind)
    body = harness.vehicle.body
    there = harness.vehicle.body.frame.to_global(30.0, 10.0, 0.0)[:2]

    def done(*words):
        result = mav("vehicle", *words)
        assert (result.code, result.err) == (0, "")
        return result.out

    assert done("arm") == "vehicle 1: armed\n"
    measured = re.fullmatch(r"vehicle 1: (\d+\.\d) m above home\n", done("takeoff", 12))
    assert float(measured[1]) == pytest.approx(-body.truth.down, abs=0.5)
    assert -body.truth.down == pytest.approx(12, abs=1.5)
    assert done("speed", 6) == "vehicle 1: speed set to 6 m/s\n"
    assert done("goto", *there, 15) == "vehicle 1: at the target\n"
    assert (body.truth.north, body.truth.east) == pytest.approx((30, 10), abs=3)
    assert done("yaw", 90) == "vehicle 1: heading 90°\n"
    assert done("hold") == "vehicle 1: holding\n"
    harness.vehicle.autopilot.radio.move(3, 1500)  # in CIRCLE, ArduPilot climbs and sinks by it
    assert done("orbit", *there, 15, "--radius", 15) == "vehicle 1: on the circle\n"
    assert done("rtl", "--no-wait") == "vehicle 1: returning home\n"
    assert done("land") == "vehicle 1: landed\n"
    assert not harness.vehicle.autopilot.armed


def test_a_disarmed_takeoff_sets_no_trap(simulate, mav):
    harness = simulate(PX4_COPTER)
    refused = mav("vehicle", "takeoff", 12)
    assert refused.code == 1
    assert refused.err.endswith("takeoff to 12 m of 1/1 failed: it is not armed; arm it first\n")
    assert harness.vehicle.autopilot.mode.name == "Hold"


def test_arming_where_the_vehicle_would_start_needs_an_option(simulate, mav):
    autopilot = simulate(PX4_COPTER).vehicle.autopilot
    assert mav("vehicle", "mode", "TAKEOFF").code == 0
    assert "warning: in mode TAKEOFF it starts by itself" in mav("vehicle", "health").out
    refused = mav("vehicle", "arm")
    assert refused.code == 1
    assert "in mode TAKEOFF it would start by itself; change the mode to LOITER first" in refused.err
    assert not autopilot.armed
    assert mav("vehicle", "arm", "--allow-flight").out == "vehicle 1: armed\n"


def test_a_link_as_a_word_names_the_option(mav):
    refused = mav("vehicle", "arm", "udpin://127.0.0.1:14550")
    assert refused.code == 2
    assert refused.err.endswith(
        "unrecognized arguments: udpin://127.0.0.1:14550; give the link with --url URL\n"
    )
    assert mav("vehicle", "arm", "now").err.endswith("unrecognized arguments: now\n")


def test_arming_leaves_the_mode_of_a_landing(simulate, mav):
    simulate(COPTER)
    assert mav("vehicle", "mode", "RTL").code == 0
    health = mav("vehicle", "health")
    assert (health.code, health.out) == (
        1,
        "vehicle 1: not ready to arm\n  its firmware does not arm in mode RTL\n",
    )
    assert (
        "does not arm in mode RTL; change the mode to GUIDED first"
        in mav("vehicle", "arm", "--keep-mode").err
    )
    assert mav("vehicle", "arm").code == 0


@pytest.mark.flight
def test_a_tolerance(simulate, mav):
    harness = simulate(ROVER)
    home = harness.vehicle.body.frame.to_global
    there = home(20.0, 10.0, 0.0)[:2]
    assert mav("vehicle", "arm").code == 0
    refused = mav("vehicle", "goto", *there, "--tolerance", 0.5)
    assert refused.code == 1
    assert "it stops within WP_RADIUS, 3 m; set that parameter" in refused.err
    assert mav("vehicle", "goto", *there, "--tolerance", 3.5).out == "vehicle 1: at the target\n"
    assert mav("vehicle", "rtl").out == "vehicle 1: at home\n"
    assert (harness.vehicle.body.truth.north, harness.vehicle.body.truth.east) == pytest.approx((0, 0), abs=1)


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("kind", BOTH, ids=kind_name)
def test_modes(simulate, mav, kind):
    harness = simulate(kind)
    name = "POSCTL" if kind == PX4_COPTER else "LOITER"
    assert mav("vehicle", "mode", name.lower()).out == f"vehicle 1: mode {name}\n"
    listed = json.loads(mav("vehicle", "modes", "--json").out)
    assert listed["mode"] == name
    assert name in [each["name"] for each in listed["modes"]]
    assert f"* {name}" in mav("vehicle", "modes").out
    assert harness.vehicle.autopilot.mode.name == name or kind == PX4_COPTER


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("kind", BOTH, ids=kind_name)
def test_info(simulate, mav, kind):
    simulate(kind)
    facts = json.loads(mav("vehicle", "info", "--json").out)
    assert facts["system"] == 1
    assert facts["firmware"] == ("PX4" if kind == PX4_COPTER else "ArduPilot")
    assert facts["armed"] is False
    assert facts["health"]["ready"] is True
    assert "MAVLINK2" in facts["capabilities"]
    assert facts["position"]["latitude"] == pytest.approx(47.3977, abs=0.001)
    assert facts["features"]["shell"] is (kind == PX4_COPTER)
    assert "compass" in facts["features"]["calibrations"]
    page = mav("vehicle", "info").out
    assert "\n  supports   parameters, " in page
    assert "\n  calibrates accelerometer, " in page or "\n  calibrates gyroscope, " in page
    assert page.startswith(f"vehicle 1: quadrotor, {facts['firmware']} {facts['version']}")


def test_health_exit_code(simulate, mav):
    simulate(ready=False)
    result = mav("vehicle", "health", "--json")
    assert result.code == 1
    assert json.loads(result.out)["ready"] is not True
    assert mav("vehicle", "health", "--wait", 90).out == "vehicle 1: ready to arm in mode STABILIZE\n"


def test_waiting_for_readiness_times_out(simulate, mav):
    simulate(ready=False)
    result = mav("vehicle", "health", "--wait", 1)
    assert result.code == 1
    assert result.err.startswith("mav vehicle: waiting for the readiness of 1/1 failed")


@pytest.mark.flight
def test_home(simulate, mav):
    simulate()
    assert mav("vehicle", "home", "here").code == 0
    moved = mav("vehicle", "home", "47.3978", "8.5457", "490")
    assert moved.out == "vehicle 1: home is 47.3978000 8.5457000, 490.0 m above sea\n"
    assert mav("vehicle", "home").out == moved.out


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("kind", BOTH, ids=kind_name)
def test_reboot(simulate, mav, kind):
    simulate(kind)
    assert mav("vehicle", "reboot").out == "vehicle 1: rebooted\n"


def test_refusal_is_one_line_with_the_reason(simulate, mav):
    simulate(ready=False)
    result = mav("vehicle", "arm", "--system", 1)
    assert result.code == 1
    assert result.out == ""
    assert result.err.startswith("mav vehicle: arming 1/1 failed: FAILED (Arm: ")
    assert "Arm" in result.err.split("(", 1)[1]
    assert result.err.count("\n") == 1
    result = mav("vehicle", "arm", "--json", "--system", 1)
    assert result.code == 1
    outcome = json.loads(result.out)
    assert (outcome["system"], outcome["action"], outcome["ok"]) == (1, "arm", False)
    assert outcome["error"] == result.err.removeprefix("mav vehicle: ").rstrip()


def test_force(simulate, mav):
    harness = simulate(ready=False)
    assert mav("vehicle", "arm", "--force").code == 0
    assert harness.vehicle.autopilot.armed
    assert mav("vehicle", "disarm", "--force").code == 0
    assert not harness.vehicle.autopilot.armed


@pytest.mark.flight
def test_action_timeout(simulate, mav):
    simulate()
    mav("vehicle", "mode", "guided")
    mav("vehicle", "arm")
    result = mav("vehicle", "takeoff", 100, "--action-timeout", 2)
    assert result.code == 1
    assert "not done in 2 s" in result.err


@pytest.mark.flight
def test_one_line_per_vehicle(simulate, mav):
    harness = simulate(COPTER, PX4_COPTER, COPTER)
    result = mav("vehicle", "arm", "--all")
    assert result.code == 0
    assert sorted(result.out.splitlines()) == [f"vehicle {system}: armed" for system in (1, 2, 3)]
    result = mav("vehicle", "disarm", "--systems", "1,3")
    assert sorted(result.out.splitlines()) == [f"vehicle {system}: disarmed" for system in (1, 3)]
    assert [vehicle.autopilot.armed for vehicle in harness.simulation.vehicles] == [False, True, False]
    assert mav("vehicle", "info", "--all").out.count("\n  state") == 3


@pytest.mark.flight
def test_failure_of_one_vehicle_does_not_stop_others(simulate, mav):
    simulate(COPTER, PX4_COPTER)
    result = mav("vehicle", "mode", "offboard", "--all", "--json")
    assert result.code == 1
    outcomes = {each["system"]: each for each in map(json.loads, result.out.splitlines())}
    assert outcomes[1]["ok"] is False
    assert "there is no such mode" in outcomes[1]["error"]
    plain = mav("vehicle", "mode", "guided", "--all")
    assert plain.code == 1
    assert plain.out == "vehicle 1: mode GUIDED\n"
    assert plain.err.startswith("mav vehicle: vehicle 2: ")


@pytest.mark.flight
def test_missing_vehicle(simulate, mav):
    simulate()
    for words in (["--system", "9"], ["--systems", "1,9"]):
        result = mav("vehicle", "arm", "--timeout", 2, *words)
        assert result.code == 1
        assert "vehicle 9" in result.err
        assert result.err.count("\n") == 1


@pytest.mark.parametrize(
    "words",
    [
        ["fly"], ["takeoff", "high"], ["takeoff", "nan"], ["goto", "1"], ["mode"], ["yaw"],
        ["statustext", " "],
        ["home", "x"], ["home", "1"], ["arm", "--systems", "0"], ["arm", "--all", "--systems", "1"],
    ],
)  # fmt: skip
def test_wrong_usage(mav, words):
    result = mav("vehicle", *words)
    assert result.code == 2
    assert "Traceback" not in result.err


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize(
    "words", [["takeoff", "-5"], ["goto", "95", "8"], ["orbit", "47", "8", "--radius", "0"]]
)
def test_invalid_values(simulate, mav, words):
    simulate()
    result = mav("vehicle", *words)
    assert result.code == 1
    assert result.err.count("\n") == 1


@pytest.mark.nightly
def test_examples_of_the_help_run(simulate, mav):
    harness = simulate(COPTER, COPTER, COPTER, COPTER, COPTER)
    # `mav vehicle check` fails while a low battery has no effect, as it is in ArduPilot's defaults.
    assert mav("param", "set", "BATT_FS_LOW_ACT", 2, "--system", 1).code == 0
    for line in EXAMPLES.splitlines()[1:]:
        words = shlex.split(line)[1:]
        if words[1] in NOT_OF_A_COPTER or words[1] == "renumber":  # the next lines are for system 1
            continue
        words += ["--yes"] if words[1] in CONFIRMED else []
        words += [] if "--all" in words or "--systems" in words else ["--system", "1"]
        # In CIRCLE, ArduPilot climbs and sinks by the throttle; it arms with the throttle down only.
        harness.vehicle.autopilot.radio.move(3, 1500 if words[1] == "orbit" else 1000)
        result = mav(*words)
        assert (result.code, result.err) == (0, ""), line


@pytest.fixture
def two_vehicles_with_one_id(monkeypatch):
    """Let a connection report that two vehicles use one system id."""

    def refuse(connection, system, operation):
        raise SystemIdConflictError(operation, f"{system}/1", answer="2 vehicles use system id 1")

    conflict = SimpleNamespace(senders=(1, 2))
    monkeypatch.setattr(Node, "refuse_conflict", refuse)
    monkeypatch.setattr(Node, "id_conflict", lambda connection, system: conflict)


@pytest.mark.parametrize(
    ("words", "operation"),
    [
        (["vehicle", "arm"], "arming"),
        (["vehicle", "land"], "landing"),
        (["param", "set", "RTL_ALT", 2000], "changing parameters of"),
    ],
)
def test_refusals_name_the_action(mav, simulate, two_vehicles_with_one_id, words, operation):
    """Before: "acting on 1/1 failed"."""
    simulate(COPTER)
    result = mav(*words, "--system", 1)
    assert result.code == 1
    assert f"{operation} 1/1 failed: 2 vehicles use system id 1" in result.err


def test_no_vehicle_is_ready_while_two_use_its_id(mav, simulate, two_vehicles_with_one_id):
    """Before: it was ready with exit code 0, and the conflict a warning."""
    simulate(COPTER)
    result = mav("vehicle", "health")
    assert result.code == 1
    assert result.out.splitlines()[0] == "vehicle 1: not ready to arm"
    assert "2 vehicles use system id 1" in result.out
    result = mav("vehicle", "health", "--wait", 5)
    assert (result.code, result.out) == (1, "")
    assert "waiting for the readiness of 1/1 failed: 2 vehicles use system id 1" in result.err
