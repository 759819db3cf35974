"""PX4's shell: what is typed, what it prints, what it does."""

from __future__ import annotations

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from mavstack.dialects import common
from tests.sim.px4.pilot import CMD, RESULT, Pilot

RESPOND = int(common.SerialControlFlag.RESPOND) | int(common.SerialControlFlag.EXCLUSIVE)
SHELL = common.SerialControlDev.DEV_SHELL


def write(pilot: Pilot, data: bytes) -> str:
    """Type something; gives what is printed."""
    before = len(pilot.heard)
    for start in range(0, max(len(data), 1), 70):
        part = data[start : start + 70]
        pilot.send(
            common.SerialControl(
                device=SHELL, flags=RESPOND, count=len(part), data=part, target_system=1, target_component=1
            )
        )
        pilot.run(0.06)
    pilot.run(0.5)
    printed = (message for message in pilot.heard[before:] if isinstance(message, common.SerialControl))
    return b"".join(message.data[: message.count] for message in printed).decode()


def run(pilot: Pilot, line: str) -> str:
    """Run a line; gives its output without echo and prompt."""
    printed = write(pilot, f"{line}\n".encode())
    assert printed.startswith(f"{line}\n"), printed
    assert printed.endswith("nsh> "), printed
    return printed[len(line) + 1 : -len("nsh> ")]


def test_a_line_is_echoed_and_answered() -> None:
    pilot = Pilot()
    assert write(pilot, b"\n") == "\nnsh> "
    assert run(pilot, "xyz") == "nsh: xyz: command not found\n"
    assert write(pilot, b"vex\x7fr") == "vex\b \br"
    assert "PX4 version: Release 1.16.0" in write(pilot, b" all\r\n")
    assert write(pilot, b"junk\x03") == "junk^C\nnsh> "
    assert write(pilot, b"\x1b[A\n") == "\nnsh> "
    assert run(pilot, "param 'x") == "nsh: unmatched quotation mark\n"


def test_programs_say_what_there_is() -> None:
    pilot = Pilot()
    for name in run(pilot, "help").split()[5:]:
        if name != "reboot":
            assert run(pilot, name) or name == "dmesg"
    assert "up 0:00:" in run(pilot, "uptime")
    assert "HW arch: MAVSTACK_SIM" in run(pilot, "ver all")
    assert "nav_state: Hold" in run(pilot, "listener vehicle_status")
    assert "voltage_v: 16" in run(pilot, "listener battery_status 1")
    assert "did not match" in run(pilot, "listener nothing")


def test_every_topic_can_be_listened_to() -> None:
    pilot = Pilot()
    topics = run(pilot, "listener").removeprefix("topics: ").strip().split(", ")
    assert len(topics) >= 8
    for topic in topics:
        assert f"TOPIC: {topic}\n" in run(pilot, f"listener {topic}")


def test_parameters_are_shown_and_set() -> None:
    pilot = Pilot()
    assert "MPC_XY_CRUISE" in run(pilot, "param show MPC_XY_CRU*")
    assert run(pilot, "param set MPC_XY_CRUISE 6") == "  MPC_XY_CRUISE: curr: 5.0000 -> new: 6.0000\n"
    assert pilot.vehicle.parameters["MPC_XY_CRUISE"] == 6.0
    assert pilot.all_of(common.ParamValue)[-1].param_id == "MPC_XY_CRUISE"
    assert " 1/" in run(pilot, "param show -c MPC_*")
    assert "not found" in run(pilot, "param set NOTHING 1")
    assert "no number" in run(pilot, "param set MPC_XY_CRUISE fast")
    assert "no number" in run(pilot, "param set MPC_XY_CRUISE nan")
    assert run(pilot, "param reset MPC_XY_CRUISE") == ""
    assert pilot.vehicle.parameters["MPC_XY_CRUISE"] == 5.0
    assert run(pilot, "param compare COM_LOW_BAT_ACT 3") == "equal\n"
    assert run(pilot, "param compare MPC_XY_CRUISE 3") == "not equal\n"


def test_commander_flies() -> None:
    pilot = Pilot()
    assert "INFO  [commander] Disarmed\n" in run(pilot, "commander status")
    assert "Preflight check: OK" in run(pilot, "commander check")
    assert run(pilot, "commander takeoff") == ""
    assert "Armed by internal command" in pilot.texts
    pilot.run_until(lambda: pilot.mode == "Hold" and pilot.height > 1.5)
    run(pilot, "commander disarm")
    assert pilot.texts[-1] == "Disarming denied: not landed"
    assert "currently not available" in run(pilot, "commander mode posctl")
    assert "unsupported" in run(pilot, "commander mode nothing")
    assert run(pilot, "commander land") == ""
    pilot.run_until(lambda: not pilot.autopilot.armed)
    assert "Armed by internal command" in run(pilot, "dmesg")
    assert run(pilot, "commander arm") == ""
    assert pilot.autopilot.armed
    assert run(pilot, "commander disarm") == ""
    assert pilot.texts[-1] == "Disarmed by internal command"


def test_failures_are_injected() -> None:
    pilot = Pilot()
    assert run(pilot, "failure gps off") == ""
    assert pilot.texts[-1] == "Injected: gps off, all instances"
    assert "gps" in pilot.vehicle.faults.active
    run(pilot, "failure gps ok")
    assert "gps" not in pilot.vehicle.faults.active
    assert "not found" in run(pilot, "failure gps nope")
    assert "not found" in run(pilot, "failure")
    pilot.vehicle.parameters.set("SYS_FAILURE_EN", 0)
    assert "disabled" in run(pilot, "failure gps off")


def test_it_reboots() -> None:
    pilot = Pilot()
    assert "rebooting" in run(pilot, "reboot")
    pilot.run(3.0)
    assert pilot.vehicle.boots == 2
    assert run(pilot, "dmesg").count("\n") < 3
    assert pilot.command(CMD.COMPONENT_ARM_DISARM, 1) == RESULT.ACCEPTED


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.binary(max_size=200))
def test_no_bytes_do_harm(data: bytes) -> None:
    printed = write(TYPIST, data + b"\x03")
    assert printed.endswith("^C\nnsh> ")


TYPIST = Pilot()
