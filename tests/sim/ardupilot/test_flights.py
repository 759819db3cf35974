"""Each type flies by commands: arm, up, there, home."""

from __future__ import annotations

from math import hypot

import pytest

from mavstack.dialects import common

from .harness import CMD, RESULT, ArdupilotHarness


def place(bench: ArdupilotHarness) -> tuple[float, float, float]:
    here = bench.vehicle.body.truth
    return here.north, here.east, here.down


def test_a_copter_takes_off_goes_there_and_returns() -> None:
    bench = ArdupilotHarness("copter")
    assert bench.set_mode("GUIDED") == RESULT.ACCEPTED
    bench.accepted(CMD.COMPONENT_ARM_DISARM, 1)
    bench.accepted(CMD.NAV_TAKEOFF, 0, 0, 0, 0, 0, 0, 10)
    bench.run_until(lambda: bench.autopilot.altitude > 9.5)
    assert bench.autopilot.landed_state in (common.MavLandedState.IN_AIR, common.MavLandedState.TAKEOFF)
    assert bench.reposition(40, 20, 20) == RESULT.ACCEPTED
    bench.run(20)
    north, east, down = place(bench)
    assert hypot(north - 40, east - 20) < 2
    assert down == pytest.approx(-20, abs=2)
    bench.accepted(CMD.NAV_RETURN_TO_LAUNCH)
    bench.run_until(lambda: not bench.autopilot.armed)
    north, east, _ = place(bench)
    assert hypot(north, east) < 2
    assert bench.texts[-1] == "Disarming motors"


def test_a_plane_takes_off_in_its_mode_and_circles() -> None:
    bench = ArdupilotHarness("plane")
    assert bench.command(CMD.NAV_TAKEOFF, 0, 0, 0, 0, 0, 0, 50) == RESULT.FAILED
    assert bench.set_mode("TAKEOFF") == RESULT.ACCEPTED
    bench.accepted(CMD.COMPONENT_ARM_DISARM, 1)
    bench.run_until(lambda: bench.autopilot.altitude > 45)
    assert bench.reposition(300, 100, 80) == RESULT.ACCEPTED
    bench.run(40)
    north, east, down = place(bench)
    assert 30 < hypot(north - 300, east - 100) < 100
    assert down == pytest.approx(-80, abs=10)
    bench.accepted(CMD.NAV_RETURN_TO_LAUNCH)
    bench.run(40)
    north, east, down = place(bench)
    assert hypot(north, east) < 110
    assert down == pytest.approx(-100, abs=15)


def test_a_quadplane_takes_off_upright_flies_forward_and_lands_hovering() -> None:
    bench = ArdupilotHarness("vtol")
    assert bench.set_mode("GUIDED") == RESULT.ACCEPTED
    assert bench.command(CMD.NAV_TAKEOFF, 0, 0, 0, 0, 0, 0, 20) == RESULT.FAILED
    assert "Must be armed for takeoff" in bench.texts
    bench.accepted(CMD.COMPONENT_ARM_DISARM, 1)
    bench.accepted(CMD.NAV_TAKEOFF, 0, 0, 0, 0, 0, 0, 20)
    bench.run_until(lambda: bench.autopilot.altitude > 19)
    assert bench.vehicle.body.transition == 0
    assert bench.reposition(400, 0, 40) == RESULT.ACCEPTED
    bench.run(25)
    assert bench.vehicle.body.transition == pytest.approx(1, abs=0.05)
    assert bench.set_mode("QRTL") == RESULT.ACCEPTED
    bench.run_until(lambda: not bench.autopilot.armed, timeout=240)
    north, east, _ = place(bench)
    assert hypot(north, east) < 5


@pytest.mark.parametrize("kind", ["rover", "boat"])
def test_what_drives_goes_there_and_returns(kind: str) -> None:
    bench = ArdupilotHarness(kind)
    bench.accepted(CMD.COMPONENT_ARM_DISARM, 1)
    assert bench.reposition(15, 6, 0) == RESULT.ACCEPTED
    bench.run(18)
    north, east, _ = place(bench)
    assert hypot(north - 15, east - 6) < 3
    bench.accepted(CMD.NAV_RETURN_TO_LAUNCH)
    bench.run_until(lambda: hypot(*place(bench)[:2]) < 4, timeout=40)


def test_a_sub_dives_and_surfaces() -> None:
    bench = ArdupilotHarness("sub")
    bench.accepted(CMD.COMPONENT_ARM_DISARM, 1)
    assert bench.reposition(10, 5, -6) == RESULT.ACCEPTED
    bench.run(25)
    north, east, down = place(bench)
    assert hypot(north - 10, east - 5) < 2
    assert down == pytest.approx(6, abs=1)
    bench.accepted(CMD.NAV_LAND)
    assert bench.mode == "SURFACE"
    bench.run_until(lambda: place(bench)[2] < 1, timeout=30)


def test_smart_rtl_retraces_the_way() -> None:
    bench = ArdupilotHarness("copter")
    bench.lift()
    for corner in ((20, 0), (20, 20)):
        bench.reposition(*corner, 10)
        bench.run(8)
    assert bench.set_mode("SMART_RTL") == RESULT.ACCEPTED
    bench.run_until(lambda: place(bench)[1] < 4)
    assert place(bench)[0] > 15, "back by the corner, not straight"
    bench.run_until(lambda: not bench.autopilot.armed)
    assert hypot(*place(bench)[:2]) < 3


def test_the_older_goto_of_mission_items() -> None:
    bench = ArdupilotHarness("copter")
    bench.lift()
    latitude, longitude = bench.at(20, -10)
    item = common.MissionItem(
        target_system=1,
        target_component=1,
        frame=common.MavFrame.GLOBAL_RELATIVE_ALT,
        command=common.MavCmd.NAV_WAYPOINT,
        current=2,
        x=latitude,
        y=longitude,
        z=15.0,
    )
    bench.send(item)
    answers = [message.type for message in bench.received if isinstance(message, common.MissionAck)]
    assert answers == [common.MavMissionResult.ACCEPTED]
    bench.run(15)
    north, east, down = place(bench)
    assert (north, east, down) == (
        pytest.approx(20, abs=2),
        pytest.approx(-10, abs=2),
        pytest.approx(-15, abs=2),
    )
    bench.set_mode("LOITER")
    bench.send(item)
    answers = [message.type for message in bench.received if isinstance(message, common.MissionAck)]
    assert answers[-1] == common.MavMissionResult.ERROR
