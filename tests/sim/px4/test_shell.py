"""PX4's shell: input, output and effects of its programs."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from mavstack.dialects import common
from tests.sim.px4.harness import CMD, RESULT, Px4Harness

RESPOND = int(common.SerialControlFlag.RESPOND) | int(common.SerialControlFlag.EXCLUSIVE)
SHELL = common.SerialControlDev.DEV_SHELL


def write(harness: Px4Harness, data: bytes) -> str:
    """Send input; return the output."""
    before = len(harness.received)
    for start in range(0, max(len(data), 1), 70):
        chunk = data[start : start + 70]
        harness.send(
            common.SerialControl(
                device=SHELL, flags=RESPOND, count=len(chunk), data=chunk, target_system=1, target_component=1
            )
        )
        harness.run(0.06)
    harness.run(0.5)
    printed = (message for message in harness.received[before:] if isinstance(message, common.SerialControl))
    return b"".join(message.data[: message.count] for message in printed).decode()


def run(harness: Px4Harness, line: str) -> str:
    """Run a line; return its output without echo and prompt."""
    printed = write(harness, f"{line}\n".encode())
    assert printed.startswith(f"{line}\n"), printed
    assert printed.endswith("nsh> "), printed
    return printed[len(line) + 1 : -len("nsh> ")]


def test_line_is_echoed_and_answered() -> None:
    harness = Px4Harness()
    assert write(harness, b"\n") == "\nnsh> "
    assert run(harness, "xyz") == "nsh: xyz: command not found\n"
    assert write(harness, b"vex\x7fr") == "vex\b \br"
    assert "PX4 version: Release 1.16.0" in write(harness, b" all\r\n")
    assert write(harness, b"junk\x03") == "junk^C\nnsh> "
    assert write(harness, b"\x1b[A\n") == "\nnsh> "
    assert run(harness, "param 'x") == "nsh: unmatched quotation mark\n"


def test_programs_print_the_state() -> None:
    harness = Px4Harness()
    for name in run(harness, "help").split()[5:]:
        if name != "reboot":
            assert run(harness, name) or name == "dmesg"
    assert "up 0:00:" in run(harness, "uptime")
    assert "HW arch: MAVSTACK_SIM" in run(harness, "ver all")
    assert "nav_state: Hold" in run(harness, "listener vehicle_status")
    assert "voltage_v: 16" in run(harness, "listener battery_status 1")
    assert "did not match" in run(harness, "listener nothing")


def test_listener_prints_every_topic() -> None:
    harness = Px4Harness()
    topics = run(harness, "listener").removeprefix("topics: ").strip().split(", ")
    assert len(topics) >= 8
    for topic in topics:
        assert f"TOPIC: {topic}\n" in run(harness, f"listener {topic}")


def test_parameters_are_shown_and_set() -> None:
    harness = Px4Harness()
    assert "MPC_XY_CRUISE" in run(harness, "param show MPC_XY_CRU*")
    assert run(harness, "param set MPC_XY_CRUISE 6") == "  MPC_XY_CRUISE: curr: 5.0000 -> new: 6.0000\n"
    assert harness.vehicle.parameters["MPC_XY_CRUISE"] == 6.0
    assert harness.received_of(common.ParamValue)[-1].param_id == "MPC_XY_CRUISE"
    assert " 1/" in run(harness, "param show -c MPC_*")
    assert "not found" in run(harness, "param set NOTHING 1")
    assert "no number" in run(harness, "param set MPC_XY_CRUISE fast")
    assert "no number" in run(harness, "param set MPC_XY_CRUISE nan")
    assert run(harness, "param reset MPC_XY_CRUISE") == ""
    assert harness.vehicle.parameters["MPC_XY_CRUISE"] == 5.0
    assert run(harness, "param compare COM_LOW_BAT_ACT 3") == "equal\n"
    assert run(harness, "param compare MPC_XY_CRUISE 3") == "not equal\n"


@pytest.mark.flight
def test_commander_flies() -> None:
    harness = Px4Harness()
    assert "INFO  [commander] Disarmed\n" in run(harness, "commander status")
    assert "Preflight check: OK" in run(harness, "commander check")
    assert run(harness, "commander takeoff") == ""
    assert "Armed by internal command" in harness.texts
    harness.run_until(lambda: harness.mode == "Hold" and harness.height > 1.5)
    run(harness, "commander disarm")
    assert harness.texts[-1] == "Disarming denied: not landed"
    assert "currently not available" in run(harness, "commander mode posctl")
    assert "unsupported" in run(harness, "commander mode nothing")
    assert run(harness, "commander land") == ""
    harness.run_until(lambda: not harness.autopilot.armed)
    assert "Armed by internal command" in run(harness, "dmesg")
    assert run(harness, "commander arm") == ""
    assert harness.autopilot.armed
    assert run(harness, "commander disarm") == ""
    assert harness.texts[-1] == "Disarmed by internal command"


def test_failures_are_injected() -> None:
    harness = Px4Harness()
    assert run(harness, "failure gps off") == ""
    assert harness.texts[-1] == "Injected: gps off, all instances"
    assert "gps" in harness.vehicle.faults.active
    run(harness, "failure gps ok")
    assert "gps" not in harness.vehicle.faults.active
    assert "not found" in run(harness, "failure gps nope")
    assert "not found" in run(harness, "failure")
    harness.vehicle.parameters.set("SYS_FAILURE_EN", 0)
    assert "disabled" in run(harness, "failure gps off")


def test_reboot() -> None:
    harness = Px4Harness()
    assert "rebooting" in run(harness, "reboot")
    harness.run(3.0)
    assert harness.vehicle.boots == 2
    assert run(harness, "dmesg").count("\n") < 3
    assert harness.command(CMD.COMPONENT_ARM_DISARM, 1) == RESULT.ACCEPTED


@pytest.mark.flight
@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.binary(max_size=200))
def test_random_bytes(data: bytes) -> None:
    printed = write(FUZZED, data + b"\x03")
    assert printed.endswith("^C\nnsh> ")


FUZZED = Px4Harness()
