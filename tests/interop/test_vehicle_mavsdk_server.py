"""Our API with MAVSDK's server side as the vehicle; what that can be is told in `mavsdk_vehicle`."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.dialects import common
from mavstack.errors import (
    CommandDenied,
    CommandTimeout,
    FileDenied,
    HealthTimeout,
    ParameterDenied,
    RemoteDenied,
)
from mavstack.services.mission import ItemReached, MissionItem
from mavstack.vehicle.firmware import Firmware
from mavstack.vehicle.kinds import VehicleClass
from tests.interop.mavsdk_peer import made, needs_mavsdk
from tests.interop.mavsdk_vehicle import HEIGHT, LATITUDE, LONGITUDE, served_vehicle

pytestmark = [pytest.mark.interop, needs_mavsdk]

CUSTOM = common.MavModeFlag.CUSTOM_MODE_ENABLED
AUTO, RTL, LAND = 4, 5, 6


async def until(holds, within: float = 15.0) -> None:
    async with asyncio.timeout(within):
        while not holds():  # noqa: ASYNC110 (what makes it so is in another process)
            await asyncio.sleep(0.02)


def is_in(vehicle, custom_mode: int) -> bool:
    heartbeat = vehicle.latest(common.Heartbeat)
    return heartbeat is not None and heartbeat.custom_mode == custom_mode


async def test_it_is_found() -> None:
    async with served_vehicle(system=7) as (vehicle, _):
        assert vehicle.address == (7, 1)
        assert vehicle.alive
        assert not vehicle.has_clash
        assert list(vehicle.node.vehicles) == [7]
        assert vehicle.autopilot == common.MavAutopilot.GENERIC
        assert vehicle.kind is VehicleClass.OTHER
        assert type(vehicle.firmware) is Firmware  # it is asked by what is standard
        version = await vehicle.component.version()
        assert version.can(common.MavProtocolCapability.MAVLINK2)
        assert vehicle.texts == []


async def test_typed_telemetry() -> None:
    async with served_vehicle() as (vehicle, served):
        await vehicle.next(common.VfrHud)
        await vehicle.next(common.GpsRawInt)
        here, gps, attitude = vehicle.position, vehicle.gps, vehicle.attitude
        assert (here.latitude, here.longitude) == pytest.approx((LATITUDE, LONGITUDE))
        assert (here.relative_altitude, here.heading) == (0.0, 90.0)
        assert vehicle.velocity.ground_speed == pytest.approx(2.915, abs=0.01)
        assert (attitude.roll, attitude.pitch, attitude.heading) == pytest.approx((10, -5, 90), abs=1e-3)
        assert (gps.fix, gps.satellites, gps.hdop, gps.vdop) == (common.GpsFixType._3D_FIX, 14, 0.5, 0.75)
        assert (gps.course, gps.horizontal_accuracy) == (45.0, 1.0)
        assert (vehicle.battery.volts, vehicle.battery.percent) == pytest.approx((12.4, 87), abs=0.01)
        assert vehicle.home.latitude == pytest.approx(LATITUDE)
        assert (vehicle.speeds.airspeed, vehicle.speeds.throttle) == (5.0, 40.0)
        assert (vehicle.armed, vehicle.in_air) == (False, False)
        assert vehicle.mode is None  # it has no modes by name
        await served.call(
            "telemetry_server",
            "publish_status_text",
            made("telemetry_server.StatusText", type=4, text="Ready"),
        )
        await until(lambda: vehicle.texts)
        assert vehicle.texts[0].text == "Ready"


async def test_a_stream_at_a_rate() -> None:
    async with served_vehicle() as (vehicle, _):
        # MAVSDK accepts every rate, and leaves it to the program how often it publishes.
        async with vehicle.stream(common.GlobalPositionInt, rate=5) as positions:
            heard = [await anext(positions) for _ in range(3)]
        assert {message.lat for message in heard} == {int(LATITUDE * 1e7)}
        assert heard[0].time_boot_ms < heard[2].time_boot_ms


async def test_arming_and_taking_off() -> None:
    async with served_vehicle() as (vehicle, served):
        arms = await served.server.stream("action_server", "subscribe_arm_disarm")
        await served.allow()
        await vehicle.arm()
        assert vehicle.armed is True
        assert await arms.get() == ("SUCCESS", {"arm": True, "force": False})
        await vehicle.takeoff(HEIGHT)
        assert served.asked == [("takeoff", "SUCCESS")]
        assert vehicle.position.relative_altitude == pytest.approx(HEIGHT, abs=1)
        assert vehicle.in_air is True
        await vehicle.disarm(force=True)
        assert vehicle.armed is False
        assert await arms.get() == ("SUCCESS", {"arm": False, "force": True})


async def test_what_is_denied() -> None:
    async with served_vehicle() as (vehicle, served):
        with pytest.raises(CommandDenied, match="TEMPORARILY_REJECTED") as denied:
            await vehicle.arm()
        assert denied.value.code == common.MavResult.TEMPORARILY_REJECTED
        assert vehicle.armed is False
        await served.allow(takeoff=False)
        await vehicle.arm()
        with pytest.raises(CommandDenied, match=r"NAV_TAKEOFF asked of 1/1: UNSUPPORTED"):
            await vehicle.takeoff(HEIGHT)
        assert served.asked == [("takeoff", "COMMAND_DENIED")]


async def test_a_refusal_has_the_reason_that_was_said_with_it() -> None:
    async with served_vehicle() as (vehicle, served):
        arms = await served.server.stream("action_server", "subscribe_arm_disarm")

        async def say_why() -> None:
            await arms.get()
            text = made("telemetry_server.StatusText", type=4, text="Arming denied: the hatch is open")
            await served.call("telemetry_server", "publish_status_text", text)

        saying = asyncio.create_task(say_why())
        with pytest.raises(CommandDenied, match="the hatch is open") as denied:
            await vehicle.arm()
        await saying
        assert denied.value.said == ("Arming denied: the hatch is open",)


async def test_what_it_does_not_answer_ends_in_a_typed_error() -> None:
    async with served_vehicle() as (vehicle, _):
        await until(lambda: vehicle.home is not None)
        asked = (vehicle.land(), vehicle.rtl(), vehicle.hold(), vehicle.mission.start())
        for outcome in await asyncio.gather(*asked, return_exceptions=True):
            assert isinstance(outcome, CommandTimeout)
            assert str(outcome).endswith("no answer")


async def test_whether_it_is_ready_it_does_not_say() -> None:
    async with served_vehicle() as (vehicle, _):
        await vehicle.next(common.SysStatus)
        with pytest.raises(HealthTimeout, match="does not say whether it is ready"):
            await vehicle.healthy(timeout=1)


async def test_modes() -> None:
    async with served_vehicle() as (vehicle, served):
        changes = await served.server.stream("action_server", "subscribe_flight_mode_change")
        allowed = made("action_server.AllowableFlightModes", can_auto_rtl_mode=True)
        await served.call("action_server", "set_allowable_flight_modes", allowed)
        # Its modes are PX4's, but it says that it is no PX4: what the standard says about modes is a number.
        await vehicle.component.command(common.MavCmd.DO_SET_MODE, CUSTOM, AUTO, RTL)
        assert await changes.get() == ("SUCCESS", "RETURN_TO_LAUNCH")
        await until(lambda: is_in(vehicle, RTL << 24 | AUTO << 16))
        with pytest.raises(CommandDenied, match="TEMPORARILY_REJECTED"):
            await vehicle.component.command(common.MavCmd.DO_SET_MODE, CUSTOM, AUTO, LAND)
        with pytest.raises(RemoteDenied, match="no such mode"):
            await vehicle.set_mode("RTL")


async def test_parameters() -> None:
    async with served_vehicle() as (vehicle, served):
        expected: dict[str, float] = {
            "LARGE": (1 << 31) - 1,
            "GAIN": -0.25,
            **{f"P_{n}": n for n in range(40)},
        }
        for name, value in expected.items():
            kind = "int" if isinstance(value, int) else "float"
            await served.call("param_server", f"provide_param_{kind}", name, value)
        changed = await served.server.stream("param_server", "subscribe_changed_param_float")
        assert (await vehicle.params.get("LARGE")).value == expected["LARGE"]
        fetched = await vehicle.params.fetch()
        assert {name: parameter.value for name, parameter in fetched.items()} == expected
        assert (await vehicle.params.set("GAIN", 0.5)).value == 0.5
        assert await changed.get() == {"name": "GAIN", "value": 0.5}
        assert vehicle.params.known["GAIN"].value == 0.5
        with pytest.raises(ParameterDenied, match="DOES_NOT_EXIST"):
            await vehicle.params.get("NOPE")
        with pytest.raises(ParameterDenied):
            await vehicle.params.set("NOPE", 1)


def waypoints(count: int) -> list[MissionItem]:
    return [
        MissionItem(common.MavCmd.NAV_WAYPOINT, param5=LATITUDE + n / 1e4, param6=LONGITUDE, param7=20.0 + n)
        for n in range(count)
    ]


async def test_a_mission_up_down_and_followed() -> None:
    async with served_vehicle() as (vehicle, served):
        incoming = await served.server.stream("mission_raw_server", "subscribe_incoming_mission")
        items = waypoints(3)
        await vehicle.mission.upload(items)
        assert (await incoming.get())[0] == "SUCCESS"
        assert list((await vehicle.mission.download()).items) == items
        await until(lambda: vehicle.mission.progress is not None and vehicle.mission.progress.seq == 0)
        async with vehicle.mission.items() as reached:
            for seq in range(3):
                await served.call("mission_raw_server", "set_current_item_complete")
                assert await anext(reached) == ItemReached(seq)
        # What follows the last item is a current item that there is not: its end.
        await until(lambda: vehicle.mission.progress.seq == 3)
        await vehicle.mission.set_current(1)
        assert vehicle.mission.progress.seq == 1
        await vehicle.mission.clear()
        assert len(await vehicle.mission.download()) == 0


async def test_a_fence_and_rally_points() -> None:
    async with served_vehicle() as (vehicle, _):
        corner, rally = common.MavCmd.NAV_FENCE_POLYGON_VERTEX_INCLUSION, common.MavCmd.NAV_RALLY_POINT
        fence = [
            MissionItem(corner, 3.0, param5=LATITUDE + n / 1e3, param6=LONGITUDE + n * n / 1e3)
            for n in range(3)
        ]
        places = [MissionItem(rally, param5=LATITUDE, param6=LONGITUDE, param7=30.0)]
        await vehicle.fence.upload(fence)
        await vehicle.rally.upload(places)
        assert list((await vehicle.fence.download()).items) == fence
        assert list((await vehicle.rally.download()).items) == places
        assert len(await vehicle.mission.download()) == 0


async def test_files(tmp_path) -> None:
    content = bytes(range(256)) * 120 + b"end"
    (tmp_path / "flight.ulg").write_bytes(content)
    (tmp_path / "scripts").mkdir()
    async with served_vehicle() as (vehicle, served):
        await served.call("ftp_server", "set_root_dir", str(tmp_path))
        listed = {entry.name: entry for entry in await vehicle.ftp.list("/")}
        assert sorted(listed) == ["flight.ulg", "scripts"]
        assert listed["flight.ulg"].size == len(content)
        assert await vehicle.ftp.read("/flight.ulg") == content
        await vehicle.ftp.write("/scripts/patrol.lua", content[::-1])
        assert (tmp_path / "scripts" / "patrol.lua").read_bytes() == content[::-1]
        await vehicle.ftp.remove("/scripts/patrol.lua")
        with pytest.raises(FileDenied):
            await vehicle.ftp.read("/nothing")


async def test_everything_at_once() -> None:
    async with served_vehicle() as (vehicle, served):
        await served.allow()
        for number in range(30):
            await served.call("param_server", "provide_param_int", f"P_{number}", number)
        fetched, plan, _ = await asyncio.gather(
            vehicle.params.fetch(), vehicle.mission.upload(waypoints(40)), vehicle.arm()
        )
        assert (len(fetched), len(plan), vehicle.armed) == (30, 40, True)


async def test_it_falls_silent() -> None:
    async with served_vehicle() as (vehicle, served):
        served.server._process.kill()
        await until(lambda: not vehicle.alive, within=30)
        assert vehicle.health().ready is None
