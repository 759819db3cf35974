"""MAVSDK's client plugins against the service servers."""

from __future__ import annotations

import json
from contextlib import asynccontextmanager, suppress
from functools import partial
from math import degrees

import pytest

from mavstack.dialects import common
from mavstack.services.mission import MissionItem, Plan, PlanType
from tests.interop.mavsdk_peer import MavsdkError, mavsdk_object, mavsdk_peer, needs_mavsdk
from tests.interop.vehicle import LATITUDE, LONGITUDE, vehicle_on_udp

pytestmark = [pytest.mark.interop, needs_mavsdk]

#: A value of `param.ProtocolVersion`.
EXTENDED = 1
PX4, ARDUPILOT = common.MavAutopilot.PX4, common.MavAutopilot.ARDUPILOTMEGA


@asynccontextmanager
async def ground_and_vehicle(**options):
    async with (
        vehicle_on_udp(**options) as (vehicle, port),
        mavsdk_peer(f"udpout://127.0.0.1:{port}") as ground,
    ):
        yield ground, vehicle


@pytest.mark.parametrize(("autopilot", "name"), [(PX4, "PX4"), (ARDUPILOT, "ARDUPILOT")])
async def test_mavsdk_discovers_an_autopilot(autopilot: int, name: str) -> None:
    async with ground_and_vehicle(autopilot=autopilot) as (ground, _):
        assert await ground.call("system", "autopilot_type") == name
        assert await ground.call("system", "vehicle_type") == "MULTICOPTER"
        assert await ground.call("system", "get_system_id") == 1
        version = await ground.call("info", "get_version")
        assert (version["flight_sw_major"], version["flight_sw_minor"]) == (1, 16)
        assert await ground.call("system", "is_connected")


@pytest.mark.parametrize("autopilot", [PX4, ARDUPILOT])
async def test_parameters(autopilot: int) -> None:
    async with ground_and_vehicle(autopilot=autopilot) as (ground, vehicle):
        large = vehicle.parameters["LARGE"]
        assert await ground.call("param", "get_param_int", "LARGE") == large
        assert await ground.call("param", "get_param_int", "NEGATIVE") == -7
        assert await ground.call("param", "get_param_float", "GAIN") == pytest.approx(-0.123)
        assert await ground.call("param", "set_param_int", "NEGATIVE", -1_000_000) == "SUCCESS"
        assert await ground.call("param", "set_param_float", "GAIN", 0.5) == "SUCCESS"
        assert (vehicle.parameters["NEGATIVE"], vehicle.parameters["GAIN"]) == (-1_000_000, 0.5)
        with pytest.raises(MavsdkError, match="DOES_NOT_EXIST"):
            await ground.call("param", "get_param_int", "NOPE")
        with pytest.raises(MavsdkError, match="VALUE_OUT_OF_RANGE"):
            await ground.call("param", "set_param_float", "MIS_TAKEOFF_ALT", 200.0)
        assert vehicle.parameters["MIS_TAKEOFF_ALT"] == 2.5
        every = await ground.call("param", "get_all_params")
        update = {
            each["name"]: each["value"] for kind in ("int_params", "float_params") for each in every[kind]
        }
        names = {name for name in update if name != "_HASH_CHECK"}
        assert len(names) == 44
        assert {name: update[name] for name in names} == pytest.approx(
            {name: vehicle.parameters[name] for name in names}
        )


async def test_extended_parameters() -> None:
    async with ground_and_vehicle() as (ground, vehicle):
        with suppress(MavsdkError):  # MAVSDK 4.1 selects it, and always returns UNKNOWN
            await ground.call("param", "select_component", 1, EXTENDED)
        assert await ground.call("param", "get_param_custom", "CAM_MODE") == "photo"
        assert await ground.call("param", "set_param_custom", "CAM_MODE", "video") == "SUCCESS"
        assert vehicle.extended["CAM_MODE"] == "video"
        every = await ground.call("param", "get_all_params")
        assert every["custom_params"] == [{"name": "CAM_MODE", "value": "video"}]


def items(number: int, kind: int = PlanType.MISSION) -> list[dict]:
    """Return a plan in MAVSDK's form."""
    commands = {
        PlanType.MISSION: common.MavCmd.NAV_WAYPOINT,
        PlanType.FENCE: common.MavCmd.NAV_FENCE_POLYGON_VERTEX_INCLUSION,
        PlanType.RALLY: common.MavCmd.NAV_RALLY_POINT,
    }
    return [
        {
            "seq": seq,
            "frame": int(common.MavFrame.GLOBAL_RELATIVE_ALT_INT),
            "command": int(commands[kind]),  # type: ignore[index]
            "current": int(seq == 0),
            "autocontinue": 1,
            "param1": float(number) if kind == PlanType.FENCE else 1.5,
            "x": 473_977_415 + 7 * seq,
            "y": -85_455_941 - 3 * seq,
            "z": 10.25 + seq,
            "mission_type": int(kind),
        }
        for seq in range(number)
    ]


def raw(listed: list[dict]) -> list[dict]:
    return [mavsdk_object("mission_raw.MissionItem", **item) for item in listed]


async def test_a_mission_up_and_down() -> None:
    async with ground_and_vehicle() as (ground, vehicle):
        sent = items(120)
        progress = await ground.stream("mission_raw", "subscribe_mission_progress")
        assert await ground.call("mission_raw", "upload_mission", raw(sent)) == "SUCCESS"
        plan = vehicle.mission.plan(PlanType.MISSION)
        assert len(plan) == 120
        third = MissionItem(
            common.MavCmd.NAV_WAYPOINT,
            param1=1.5,
            param5=47.3977429,
            param6=-8.5455947,
            param7=12.25,
            frame=common.MavFrame.GLOBAL_RELATIVE_ALT_INT,
        )
        assert plan.items[2] == third
        returned = await ground.call("mission_raw", "download_mission")
        assert [without_nulls(item) for item in returned] == [without_nulls(item) for item in sent]
        assert await ground.call("mission_raw", "set_current_mission_item", 7) == "SUCCESS"
        assert vehicle.mission.current == 7
        await progress.wait_for(lambda update: update == {"current": 7, "total": 120})
        vehicle.mission.set_current(8)
        vehicle.wake(vehicle.mission)
        await progress.wait_for(lambda update: update == {"current": 8, "total": 120})
        assert await ground.call("mission_raw", "clear_mission") == "SUCCESS"
        assert len(vehicle.mission.plan(PlanType.MISSION)) == 0
        assert await ground.call("mission_raw", "download_mission") == []


def without_nulls(item: dict) -> dict:
    return {name: value for name, value in item.items() if value}


async def test_upload_reports_progress_and_replaces_the_plan() -> None:
    async with ground_and_vehicle() as (ground, vehicle):
        old = Plan.of([MissionItem(common.MavCmd.NAV_TAKEOFF, param7=5.0)])
        vehicle.mission.replace(old)
        plan = mavsdk_object("mission_raw.MissionPlan", mission_items=raw(items(30)))
        steps = await ground.stream("mission_raw", "upload_mission_with_progress_async", plan)
        await steps.wait_for(lambda update: update[0] == "SUCCESS")
        assert len(vehicle.mission.plan(PlanType.MISSION)) == 30


@pytest.mark.parametrize(
    ("kind", "up", "down"),
    [
        (PlanType.FENCE, "upload_geofence", "download_geofence"),
        (PlanType.RALLY, "upload_rally_points", "download_rallypoints"),
    ],
)
async def test_fence_and_rally_points(kind: int, up: str, down: str) -> None:
    async with ground_and_vehicle() as (ground, vehicle):
        sent = items(5, kind)
        assert await ground.call("mission_raw", up, raw(sent)) == "SUCCESS"
        assert len(vehicle.mission.plan(kind)) == 5
        assert len(vehicle.mission.plan(PlanType.MISSION)) == 0
        returned = await ground.call("mission_raw", down)
        for item in returned + sent:
            item.pop("current", None)
        assert [without_nulls(item) for item in returned] == [without_nulls(item) for item in sent]


async def test_a_refused_mission_keeps_the_old_plan() -> None:
    async with ground_and_vehicle() as (ground, vehicle):
        vehicle.mission.limits[PlanType.MISSION] = 10
        with pytest.raises(MavsdkError, match="TOO_MANY_MISSION_ITEMS"):
            await ground.call("mission_raw", "upload_mission", raw(items(11)))
        assert len(vehicle.mission.plan(PlanType.MISSION)) == 0


async def test_log_files(tmp_path) -> None:
    async with ground_and_vehicle() as (ground, vehicle):
        content = vehicle.logs.contents[1] = bytes(range(251)) * 300
        entries = await ground.call("log_files", "get_entries")
        assert entries == [
            {"id": 1, "date": "2023-11-14T22:13:20Z", "size_bytes": len(content)},
            {"id": 2, "date": "2023-11-14T22:13:20Z", "size_bytes": 5},
        ]
        for entry in entries:
            saved = tmp_path / f"{entry['id']}.bin"
            entry_object = mavsdk_object("log_files.Entry", **entry)
            steps = await ground.stream("log_files", "download_log_file_async", entry_object, str(saved))
            result, _ = await steps.wait_for(lambda update: update[0] != "NEXT")
            assert result == "SUCCESS"
            assert saved.read_bytes() == vehicle.logs.contents[entry["id"]]
        async with vehicle.stream(common.LogErase) as erased:
            assert await ground.call("log_files", "erase_all_log_files") == "SUCCESS"
            await anext(erased)
        assert vehicle.logs.contents == {}


async def test_telemetry() -> None:
    # MAVSDK 4.1 divides the throttle of VFR_HUD, in percent, by 100 and still calls it a percentage.
    expected = {
        "position": {
            "latitude_deg": LATITUDE,
            "longitude_deg": LONGITUDE,
            "absolute_altitude_m": 488.5,
            "relative_altitude_m": 12.25,
        },
        "home": {"latitude_deg": LATITUDE, "absolute_altitude_m": 476.25},
        "velocity_ned": {"north_m_s": 1.5, "east_m_s": -2.5, "down_m_s": -0.5},
        "heading": {"heading_deg": 90.0},
        "gps_info": {"num_satellites": 14, "fix_type": "RTK_FIXED"},
        "raw_gps": {"hdop": 0.8, "vdop": 1.2},
        "battery": {"remaining_percent": 87.0, "current_battery_a": 15.0, "id": 0},
        "attitude_euler": {
            "roll_deg": degrees(0.1),
            "pitch_deg": degrees(-0.2),
            "yaw_deg": degrees(1.5),
        },
        "fixedwing_metrics": {"airspeed_m_s": 5.0, "throttle_percentage": 0.4, "climb_rate_m_s": 0.5},
        "rc_status": {"signal_strength_percent": 80.0},
        "landed_state": "ON_GROUND",
        "armed": False,
        "in_air": False,
    }
    async with ground_and_vehicle() as (ground, _):
        for name, fields in expected.items():
            update = await ground.stream("telemetry", f"subscribe_{name}")
            await update.wait_for(partial(agrees, fields))


def agrees(expected, value) -> bool:
    """Return whether a value, or its fields, equal the expected ones within float32 precision."""
    if not isinstance(expected, dict):
        return value == expected
    return all(
        value[name] == (each if isinstance(each, str) else pytest.approx(each, rel=1e-5))
        for name, each in expected.items()
    )


async def test_health_texts_and_rates() -> None:
    async with ground_and_vehicle() as (ground, vehicle):
        texts = await ground.stream("telemetry", "subscribe_status_text")
        long = "A text of more than fifty letters is sent in chunks and received as one text: " + "x" * 60
        vehicle.send_statustext("Ready to fly", common.MavSeverity.WARNING)
        vehicle.send_statustext(long, common.MavSeverity.CRITICAL)
        assert await texts.wait_for(lambda update: update["type"] == "CRITICAL") == {
            "type": "CRITICAL",
            "text": long,
        }
        health = await ground.stream("telemetry", "subscribe_health")
        await health.wait_for(lambda update: update["is_gyrometer_calibration_ok"])
        assert await ground.call("telemetry", "set_rate_position", 20.0) == "SUCCESS"
        assert vehicle.message_server.interval_of(common.GlobalPositionInt) == 50_000


@pytest.mark.smoke
async def test_actions() -> None:
    async with ground_and_vehicle() as (ground, vehicle):
        armed = await ground.stream("telemetry", "subscribe_armed")
        landed = await ground.stream("telemetry", "subscribe_landed_state")
        modes = await ground.stream("telemetry", "subscribe_flight_mode")
        with pytest.raises(MavsdkError, match=r"COMMAND_DENIED"):
            await ground.call("action", "takeoff")
        assert await ground.call("action", "arm") == "SUCCESS"
        await armed.wait_for(lambda update: update)
        assert vehicle.is_armed
        assert await ground.call("action", "get_takeoff_altitude") == 2.5
        assert await ground.call("action", "set_takeoff_altitude", 15.0) == "SUCCESS"
        assert vehicle.parameters["MIS_TAKEOFF_ALT"] == 15.0
        assert await ground.call("action", "takeoff") == "SUCCESS"
        assert len(vehicle.takeoffs) == 1
        await landed.wait_for(lambda update: update == "IN_AIR")
        with pytest.raises(MavsdkError, match="COMMAND_DENIED"):
            await ground.call("action", "disarm")
        assert await ground.call("action", "return_to_launch") == "SUCCESS"
        await modes.wait_for(lambda update: update == "RETURN_TO_LAUNCH")
        assert await ground.call("action", "land") == "SUCCESS"
        await landed.wait_for(lambda update: update == "ON_GROUND")
        assert await ground.call("action", "disarm") == "SUCCESS"
        assert not vehicle.is_armed
        assert await ground.call("action", "set_home", True, 0.0, 0.0, 0.0) == "SUCCESS"
        with pytest.raises(MavsdkError, match="UNSUPPORTED"):
            await ground.call("action", "set_relay", 0, 0)


async def test_a_shell() -> None:
    async with ground_and_vehicle() as (ground, _):
        received = await ground.stream("shell", "subscribe_receive")
        assert await ground.call("shell", "send", "ver all", 10) == "SUCCESS"
        await received.wait_for(lambda update: "echo: ver all" in update["data"])


async def test_any_message_direct() -> None:
    async with ground_and_vehicle() as (ground, vehicle):
        tune = mavsdk_object(
            "mavlink_direct.MavlinkMessage",
            message_name="PLAY_TUNE_V2",
            system_id=245,
            component_id=190,
            target_system_id=1,
            target_component_id=1,
            fields_json='{"target_system": 1, "target_component": 1, "format": 1, "tune": "MFT200L8<c"}',
        )
        async with vehicle.stream(common.PlayTuneV2) as update:
            assert await ground.call("mavlink_direct", "send_message", tune) == "SUCCESS"
            message = await anext(update)
        assert (message.tune, message.format) == ("MFT200L8<c", 1)
        attitudes = await ground.stream("mavlink_direct", "subscribe_message", "ATTITUDE")
        attitude = json.loads((await attitudes.get())["fields_json"])
        assert (attitude["roll"], attitude["yaw"]) == pytest.approx((0.1, 1.5))


async def test_files(tmp_path) -> None:
    root, local = tmp_path / "root", tmp_path / "local"
    (root / "logs").mkdir(parents=True)
    local.mkdir()
    content = bytes(range(256)) * 300 + b"end"
    (root / "logs" / "flight.ulg").write_bytes(content)
    (root / "empty.txt").write_bytes(b"")
    async with ground_and_vehicle(root=root) as (ground, _):
        listed = await ground.call("ftp", "list_directory", "/logs")
        assert [(entry["name"], entry["size_bytes"]) for entry in listed["entries"]] == [
            ("flight.ulg", len(content))
        ]
        for burst in (False, True):
            steps = await ground.stream("ftp", "download_async", "/logs/flight.ulg", str(local), burst)
            assert (await steps.wait_for(lambda update: update[0] != "NEXT"))[0] == "SUCCESS"
            assert (local / "flight.ulg").read_bytes() == content
            (local / "flight.ulg").unlink()
        steps = await ground.stream("ftp", "download_async", "/empty.txt", str(local), True)
        assert (await steps.wait_for(lambda update: update[0] != "NEXT"))[0] == "SUCCESS"
        assert (local / "empty.txt").read_bytes() == b""
        (local / "up.bin").write_bytes(content[::-1])
        steps = await ground.stream("ftp", "upload_async", str(local / "up.bin"), "/logs")
        assert (await steps.wait_for(lambda update: update[0] != "NEXT"))[0] == "SUCCESS"
        assert (root / "logs" / "up.bin").read_bytes() == content[::-1]
        assert await ground.call("ftp", "are_files_identical", str(local / "up.bin"), "/logs/up.bin")
        assert not await ground.call("ftp", "are_files_identical", str(local / "up.bin"), "/logs/flight.ulg")


async def test_the_file_tree(tmp_path) -> None:
    (tmp_path / "a.txt").write_bytes(b"a")
    async with ground_and_vehicle(root=tmp_path) as (ground, _):
        assert await ground.call("ftp", "create_directory", "/new") == "SUCCESS"
        assert await ground.call("ftp", "rename", "/a.txt", "/new/b.txt") == "SUCCESS"
        assert (tmp_path / "new" / "b.txt").read_bytes() == b"a"
        with pytest.raises(MavsdkError, match="FILE_EXISTS"):
            await ground.call("ftp", "create_directory", "/new")
        with pytest.raises(MavsdkError, match="FILE_DOES_NOT_EXIST"):
            await ground.call("ftp", "remove_file", "/a.txt")
        with pytest.raises(MavsdkError, match="FtpError"):
            await ground.call("ftp", "remove_directory", "/new")
        with pytest.raises(MavsdkError, match="FtpError"):
            await ground.call("ftp", "list_directory", "/../..")
        assert await ground.call("ftp", "remove_file", "/new/b.txt") == "SUCCESS"
        assert await ground.call("ftp", "remove_directory", "/new") == "SUCCESS"
        assert list(tmp_path.iterdir()) == []
