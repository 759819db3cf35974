"""The vehicle API with a vehicle of MAVSDK's server plugins (see `mavsdk_vehicle`)."""

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
from mavstack.vehicle.vehicle_type import VehicleType
from tests.interop.mavsdk_peer import mavsdk_object, needs_mavsdk
from tests.interop.mavsdk_vehicle import HEIGHT, LATITUDE, LONGITUDE, mavsdk_server_vehicle
from tests.waiting import wait_until

pytestmark = [pytest.mark.interop, needs_mavsdk]

CUSTOM = common.MavModeFlag.CUSTOM_MODE_ENABLED
AUTO, RTL, LAND = 4, 5, 6


def is_in(vehicle, custom_mode: int) -> bool:
    heartbeat = vehicle.latest(common.Heartbeat)
    return heartbeat is not None and heartbeat.custom_mode == custom_mode


async def test_the_vehicle_is_found() -> None:
    async with mavsdk_server_vehicle(system=7) as (vehicle, _):
        assert vehicle.address == (7, 1)
        assert vehicle.alive
        assert not vehicle.has_id_conflict
        assert list(vehicle.connection.vehicles) == [7]
        assert vehicle.autopilot == common.MavAutopilot.GENERIC
        assert vehicle.vehicle_type is VehicleType.OTHER
        assert type(vehicle.firmware) is Firmware  # the standard firmware profile
        version = await vehicle.component.get_version()
        assert version.can(common.MavProtocolCapability.MAVLINK2)
        assert vehicle.status_texts == []


async def test_typed_telemetry() -> None:
    async with mavsdk_server_vehicle() as (vehicle, served):
        await vehicle.wait_for_message(common.VfrHud)
        await vehicle.wait_for_message(common.GpsRawInt)
        here, gps, attitude = vehicle.position, vehicle.gps, vehicle.attitude
        assert (here.latitude, here.longitude) == pytest.approx((LATITUDE, LONGITUDE))
        assert (here.relative_altitude, here.heading) == (0.0, 90.0)
        assert vehicle.velocity.ground_speed == pytest.approx(2.915, abs=0.01)
        assert (attitude.roll, attitude.pitch, attitude.heading) == pytest.approx((10, -5, 90), abs=1e-3)
        assert (gps.fix, gps.satellites, gps.hdop, gps.vdop) == (common.GpsFixType._3D_FIX, 14, 0.5, 0.75)
        assert (gps.course, gps.horizontal_accuracy) == (45.0, 1.0)
        assert (vehicle.battery.voltage, vehicle.battery.remaining) == pytest.approx((12.4, 87), abs=0.01)
        assert vehicle.home.latitude == pytest.approx(LATITUDE)
        assert (vehicle.vfr_hud.airspeed, vehicle.vfr_hud.throttle) == (5.0, 40.0)
        assert (vehicle.armed, vehicle.in_air) == (False, False)
        assert vehicle.mode is None  # it has no modes by name
        await served.call(
            "telemetry_server",
            "publish_status_text",
            mavsdk_object("telemetry_server.StatusText", type=4, text="Ready"),
        )
        await wait_until(lambda: vehicle.status_texts)
        assert vehicle.status_texts[0].text == "Ready"


async def test_a_stream_at_a_rate() -> None:
    async with mavsdk_server_vehicle() as (vehicle, _):
        # MAVSDK accepts every rate but publishes at the program's own.
        async with vehicle.stream(common.GlobalPositionInt, rate=5) as positions:
            received = [await anext(positions) for _ in range(3)]
        assert {message.lat for message in received} == {int(LATITUDE * 1e7)}
        assert received[0].time_boot_ms < received[2].time_boot_ms


async def test_arming_and_taking_off() -> None:
    async with mavsdk_server_vehicle() as (vehicle, served):
        arms = await served.server.stream("action_server", "subscribe_arm_disarm")
        await served.allow()
        await vehicle.arm()
        assert vehicle.armed is True
        assert await arms.get() == ("SUCCESS", {"arm": True, "force": False})
        await vehicle.takeoff(HEIGHT)
        assert served.requests == [("takeoff", "SUCCESS")]
        assert vehicle.position.relative_altitude == pytest.approx(HEIGHT, abs=1)
        assert vehicle.in_air is True
        await vehicle.disarm(force=True)
        assert vehicle.armed is False
        assert await arms.get() == ("SUCCESS", {"arm": False, "force": True})


async def test_denied_requests() -> None:
    async with mavsdk_server_vehicle() as (vehicle, served):
        with pytest.raises(CommandDenied, match="TEMPORARILY_REJECTED") as denied:
            await vehicle.arm()
        assert denied.value.code == common.MavResult.TEMPORARILY_REJECTED
        assert vehicle.armed is False
        await served.allow(takeoff=False)
        await vehicle.arm()
        with pytest.raises(CommandDenied, match=r"NAV_TAKEOFF on 1/1 failed: UNSUPPORTED"):
            await vehicle.takeoff(HEIGHT)
        assert served.requests == [("takeoff", "COMMAND_DENIED")]


async def test_a_denied_command_carries_the_status_text() -> None:
    async with mavsdk_server_vehicle() as (vehicle, served):
        arms = await served.server.stream("action_server", "subscribe_arm_disarm")

        async def send_status_text() -> None:
            await arms.get()
            text = mavsdk_object(
                "telemetry_server.StatusText", type=4, text="Arming denied: the hatch is open"
            )
            await served.call("telemetry_server", "publish_status_text", text)

        sending = asyncio.create_task(send_status_text())
        with pytest.raises(CommandDenied, match="the hatch is open") as denied:
            await vehicle.arm()
        await sending
        assert denied.value.status_texts == ("Arming denied: the hatch is open",)


async def test_unanswered_commands_time_out() -> None:
    async with mavsdk_server_vehicle() as (vehicle, _):
        await wait_until(lambda: vehicle.home is not None)
        servo, beep = common.MavCmd.DO_SET_SERVO, common.MavCmd.DO_SET_RELAY
        calls = (vehicle.command(servo, 1, 1500), vehicle.command(beep, 1, 1))
        for outcome in await asyncio.gather(*calls, return_exceptions=True):
            assert isinstance(outcome, CommandTimeout)
            assert str(outcome).endswith("no answer")


async def test_readiness_is_unknown() -> None:
    async with mavsdk_server_vehicle() as (vehicle, _):
        await vehicle.wait_for_message(common.SysStatus)
        with pytest.raises(HealthTimeout, match="readiness not reported"):
            await vehicle.wait_until_ready(timeout=1)


async def test_modes() -> None:
    async with mavsdk_server_vehicle() as (vehicle, served):
        changes = await served.server.stream("action_server", "subscribe_flight_mode_change")
        allowed = mavsdk_object("action_server.AllowableFlightModes", can_auto_rtl_mode=True)
        await served.call("action_server", "set_allowable_flight_modes", allowed)
        # It uses PX4's modes but announces no firmware, so a mode is only a number.
        await vehicle.component.command(common.MavCmd.DO_SET_MODE, CUSTOM, AUTO, RTL)
        assert await changes.get() == ("SUCCESS", "RETURN_TO_LAUNCH")
        await wait_until(lambda: is_in(vehicle, RTL << 24 | AUTO << 16))
        with pytest.raises(CommandDenied, match="TEMPORARILY_REJECTED"):
            await vehicle.component.command(common.MavCmd.DO_SET_MODE, CUSTOM, AUTO, LAND)
        with pytest.raises(RemoteDenied, match="no such mode"):
            await vehicle.set_mode("RTL")


async def test_parameters() -> None:
    async with mavsdk_server_vehicle() as (vehicle, served):
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
        fetched = await vehicle.params.download()
        assert {name: parameter.value for name, parameter in fetched.items()} == expected
        assert (await vehicle.params.set("GAIN", 0.5)).value == 0.5
        assert await changed.get() == {"name": "GAIN", "value": 0.5}
        assert vehicle.params.cached["GAIN"].value == 0.5
        with pytest.raises(ParameterDenied, match="DOES_NOT_EXIST"):
            await vehicle.params.get("NOPE")
        with pytest.raises(ParameterDenied):
            await vehicle.params.set("NOPE", 1)


def waypoints(count: int) -> list[MissionItem]:
    return [
        MissionItem(common.MavCmd.NAV_WAYPOINT, param5=LATITUDE + n / 1e4, param6=LONGITUDE, param7=20.0 + n)
        for n in range(count)
    ]


async def test_mission_transfer_and_progress() -> None:
    async with mavsdk_server_vehicle() as (vehicle, served):
        incoming = await served.server.stream("mission_raw_server", "subscribe_incoming_mission")
        items = waypoints(3)
        await vehicle.mission.upload(items)
        assert (await incoming.get())[0] == "SUCCESS"
        assert list((await vehicle.mission.download()).items) == items
        await wait_until(lambda: vehicle.mission.progress is not None and vehicle.mission.progress.seq == 0)
        async with vehicle.mission.reached_items() as reached:
            for seq in range(3):
                await served.call("mission_raw_server", "set_current_item_complete")
                assert await anext(reached) == ItemReached(seq)
        # After the last item the current item is one past the end.
        await wait_until(lambda: vehicle.mission.progress.seq == 3)
        await vehicle.mission.set_current(1)
        assert vehicle.mission.progress.seq == 1
        await vehicle.mission.clear()
        assert len(await vehicle.mission.download()) == 0


async def test_a_fence_and_rally_points() -> None:
    async with mavsdk_server_vehicle() as (vehicle, _):
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
    async with mavsdk_server_vehicle() as (vehicle, served):
        await served.call("ftp_server", "set_root_dir", str(tmp_path))
        listed = {entry.name: entry for entry in await vehicle.ftp.list("/")}
        assert sorted(listed) == ["flight.ulg", "scripts"]
        assert listed["flight.ulg"].size == len(content)
        assert await vehicle.ftp.download("/flight.ulg") == content
        await vehicle.ftp.upload("/scripts/patrol.lua", content[::-1])
        assert (tmp_path / "scripts" / "patrol.lua").read_bytes() == content[::-1]
        await vehicle.ftp.remove("/scripts/patrol.lua")
        with pytest.raises(FileDenied):
            await vehicle.ftp.download("/nothing")


async def test_concurrent_calls() -> None:
    async with mavsdk_server_vehicle() as (vehicle, served):
        await served.allow()
        for number in range(30):
            await served.call("param_server", "provide_param_int", f"P_{number}", number)
        fetched, plan, _ = await asyncio.gather(
            vehicle.params.download(), vehicle.mission.upload(waypoints(40)), vehicle.arm()
        )
        assert (len(fetched), len(plan), vehicle.armed) == (30, 40, True)


async def test_a_silent_vehicle_is_lost() -> None:
    async with mavsdk_server_vehicle() as (vehicle, served):
        served.server._process.kill()
        await wait_until(lambda: not vehicle.alive, timeout=30)
        assert vehicle.health.ready is None
