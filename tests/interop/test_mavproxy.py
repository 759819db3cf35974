"""MAVProxy as a ground station, against the service servers."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.services.mission import MissionItem, Plan
from mavstack.services.parameters import ParameterWritten
from tests.interop.mavproxy import mavproxy, needs_mavproxy
from tests.interop.vehicle import vehicle_on_udp

pytestmark = [pytest.mark.interop, needs_mavproxy]

MODULES = "param,mode,arm,wp,cmdlong,ftp,link"


@pytest.mark.smoke
async def test_mavproxy_controls_a_vehicle(tmp_path) -> None:
    (tmp_path / "files").mkdir()
    (tmp_path / "files" / "hello.txt").write_bytes(b"hello there")
    async with (
        vehicle_on_udp(autopilot=common.MavAutopilot.ARDUPILOTMEGA, root=tmp_path / "files") as (
            vehicle,
            port,
        ),
        mavproxy(port, tmp_path, modules=MODULES) as console,
    ):
        vehicle.mission.replace(Plan.of([MissionItem(common.MavCmd.NAV_WAYPOINT, param7=7.0)] * 25))
        await console.wait_for_output("Detected vehicle 1:1")
        await console.wait_for_output("Received 44 parameters")
        async with vehicle.events(ParameterWritten) as written:
            console.send_line("param set GAIN 0.5")
            await anext(written)
        console.send_line("mode GUIDED")
        await console.wait_for_output("Mode GUIDED")
        console.send_line("arm throttle")
        await console.wait_for_output("ARMED")
        assert vehicle.is_armed
        assert vehicle.modes.current.custom_mode == 4
        assert vehicle.parameters["GAIN"] == 0.5
        console.send_line("wp save plan.txt")
        await console.wait_for_output("Saved 25 waypoints")
        vehicle.mission.replace(Plan(common.MavMissionType.MISSION))
        console.send_line("wp load plan.txt")
        await console.wait_for_output("Loaded 25 waypoints")
        await console.wait_for_output("TYPE_MISSION: ACCEPTED")
        assert len(vehicle.mission.plan(common.MavMissionType.MISSION)) == 25
        console.send_line("ftp get hello.txt")
        await console.wait_for_output("Wrote 11 bytes")
        console.send_line("ftp list /")
        await console.wait_for_output("Total size")  # printed after the file is closed
        assert (tmp_path / "hello.txt").read_bytes() == b"hello there"
