"""MAVProxy as a ground station, in a process of its own, against our servers."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.services.mission import MissionItem, Plan
from mavstack.services.parameters import ParameterWritten
from tests.interop.mavproxy import mavproxy, needs_mavproxy
from tests.interop.vehicle import vehicle_on_udp

pytestmark = [pytest.mark.interop, needs_mavproxy]

MODULES = "param,mode,arm,wp,cmdlong,ftp,link"


async def test_it_controls_our_vehicle(tmp_path) -> None:
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
        await console.hear("Detected vehicle 1:1")
        await console.hear("Received 44 parameters")
        async with vehicle.events(ParameterWritten) as written:
            console.say("param set GAIN 0.5")
            await anext(written)
        console.say("mode GUIDED")
        await console.hear("Mode GUIDED")
        console.say("arm throttle")
        await console.hear("ARMED")
        assert vehicle.is_armed
        assert vehicle.modes.current.custom_mode == 4
        assert vehicle.parameters["GAIN"] == 0.5
        console.say("wp save plan.txt")
        await console.hear("Saved 25 waypoints")
        vehicle.mission.replace(Plan(common.MavMissionType.MISSION))
        console.say("wp load plan.txt")
        await console.hear("Loaded 25 waypoints")
        await console.hear("TYPE_MISSION: ACCEPTED")
        assert len(vehicle.mission.plan(common.MavMissionType.MISSION)) == 25
        console.say("ftp get hello.txt")
        await console.hear("Wrote 11 bytes")
        console.say("ftp list /")
        await console.hear("Total size")  # by then it has closed the file
        assert (tmp_path / "hello.txt").read_bytes() == b"hello there"
