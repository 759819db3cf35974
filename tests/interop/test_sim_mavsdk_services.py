"""MAVSDK with the services of simulated vehicles: telemetry, parameters, files, logs, plans."""

from __future__ import annotations

from functools import partial

import pytest

from mavstack.dialects import common
from tests.interop.mavsdk_peer import mavsdk_object, needs_mavsdk
from tests.interop.simulated import simulated_flight

pytestmark = [pytest.mark.interop, needs_mavsdk]

CMD = common.MavCmd
FIRMWARES = ("ardupilot", "px4")


def near(name: str, expected: float, tolerance: float):
    return lambda update: update[name] == pytest.approx(expected, abs=tolerance)


def at_rest(imu: dict, gravity: float = 9.81) -> bool:
    return imu["acceleration_frd"]["down_m_s2"] == pytest.approx(-gravity, rel=0.05)


#: Expected telemetry of a copter on the ground, for both firmwares.
COMMON_TELEMETRY = {
    "position": near("relative_altitude_m", 0, 1),
    "home": near("absolute_altitude_m", 488, 1),
    "in_air": lambda update: update is False,
    "landed_state": lambda update: update == "ON_GROUND",
    "armed": lambda update: update is False,
    "vtol_state": lambda update: update == "UNDEFINED",
    "attitude_quaternion": near("w", 1, 0.01),
    "attitude_euler": near("roll_deg", 0, 1),
    "attitude_angular_velocity_body": near("roll_rad_s", 0, 0.1),
    "velocity_ned": near("north_m_s", 0, 0.5),
    "gps_info": lambda update: update == {"num_satellites": 14, "fix_type": "FIX_3D"},
    "raw_gps": near("latitude_deg", 47.3977, 1e-3),
    "battery": near("remaining_percent", 100, 1),
    "flight_mode": lambda update: update in ("HOLD", "STABILIZED"),
    "health": lambda update: all(update.values()),
    "health_all_ok": lambda update: update is True,
    "position_velocity_ned": lambda update: abs(update["position"]["down_m"]) < 1,
    "fixedwing_metrics": near("groundspeed_m_s", 0, 0.5),
    "imu": at_rest,
    "scaled_imu": at_rest,
    "raw_imu": partial(at_rest, gravity=1000),
    "unix_epoch_time": lambda update: update > 1_767_225_600_000_000,
    "scaled_pressure": near("absolute_pressure_hpa", 956, 1),
    "distance_sensor": near("current_distance_m", 0, 0.2),
    "heading": lambda update: min(update["heading_deg"], 360 - update["heading_deg"]) < 3,
}
FIRMWARE_TELEMETRY = {
    "ardupilot": {"rc_status": lambda update: update["is_available"]},
    "px4": {
        "rc_status": lambda update: not update["is_available"],
        "odometry": lambda update: abs(update["position_body"]["z_m"]) < 1,
        "altitude": near("altitude_amsl_m", 488, 1),
        "actuator_output_status": lambda update: update["actuator"][0] == -1,
        "ground_truth": near("absolute_altitude_m", 488, 0.1),
    },
}
#: Telemetry without a rate of its own: it is derived from other messages.
WITHOUT_RATE = {"armed", "flight_mode", "health_all_ok", "heading", "scaled_pressure"}
WITHOUT_RATE |= {"attitude_angular_velocity_body", "wind"}
#: Parameters that enable a rangefinder; PX4 has one by default.
RANGEFINDER_PARAMETERS = {"ardupilot": {"RNGFND1_TYPE": 100}, "px4": {}}


@pytest.mark.parametrize("firmware", FIRMWARES)
async def test_telemetry(firmware: str) -> None:
    expected = COMMON_TELEMETRY | FIRMWARE_TELEMETRY[firmware]
    async with simulated_flight("copter", firmware, **RANGEFINDER_PARAMETERS[firmware]) as flight:
        await flight.wait_for_telemetry("health_all_ok", True)
        for name in expected.keys() - WITHOUT_RATE:
            await flight.call_ok("telemetry", f"set_rate_{name}", 5.0)
        for name, condition in expected.items():
            await flight.wait_for_telemetry(name, condition)
        origin = await flight.call("telemetry", "get_gps_global_origin")
        assert origin["latitude_deg"] == pytest.approx(47.3977418)
        await flight.call_fails("COMMAND_DENIED", "telemetry", "set_rate_actuator_control_target", 5.0)
        await check_rates(flight)
        await check_version(flight, firmware)


async def check_rates(flight) -> None:
    """A rate is kept in simulated time."""
    await flight.call_ok("telemetry", "set_rate_attitude_euler", 2.0)
    update = await flight.ground.stream("telemetry", "subscribe_attitude_euler")
    first = await update.get()
    times = [(await update.get())["timestamp_us"] for _ in range(5)]
    assert times[0] > first["timestamp_us"]
    assert (times[4] - times[0]) / 4e6 == pytest.approx(0.5, abs=0.05)


async def check_version(flight, firmware: str) -> None:
    version = await flight.call("info", "get_version")
    assert version["flight_sw_major"] == {"ardupilot": 4, "px4": 1}[firmware]
    assert version["flight_sw_version_type"] == "RELEASE"
    identification = await flight.call("info", "get_identification")
    assert int(identification["hardware_uid"].rstrip("\0"), 16)
    assert await flight.call("info", "get_product")
    flown = await flight.ground.stream("info", "subscribe_flight_information")
    await flown.wait_for(
        lambda update: update["time_boot_ms"] > 0 and update["duration_since_arming_ms"] == 0
    )
    # MAVSDK 4.1 always reports its own speed factor as NaN.


@pytest.mark.parametrize("firmware", FIRMWARES)
async def test_parameters_and_files(firmware: str, tmp_path) -> None:
    async with simulated_flight("copter", firmware) as flight:
        await check_parameters(
            flight,
            *{
                "ardupilot": ("RTL_ALT", "WPNAV_SPEED", 750.0),
                "px4": ("COM_RC_IN_MODE", "MPC_XY_CRUISE", 6.5),
            }[firmware],
        )
        await check_files(flight, {"ardupilot": "/APM/scripts", "px4": "/fs/microsd/etc"}[firmware], tmp_path)


async def check_parameters(flight, whole: str, real: str, value: float) -> None:
    table = flight.vehicle.parameters
    every = await flight.call("param", "get_all_params")
    update = {each["name"]: each["value"] for kind in ("int_params", "float_params") for each in every[kind]}
    names = {name for name in update if name != "_HASH_CHECK"}
    assert names == {each.name for each in table.table}
    assert len(names) > 300
    assert {name: update[name] for name in names} == pytest.approx({name: table[name] for name in names})
    assert await flight.call("param", "get_param_int", whole) == table[whole]
    await flight.call_ok("param", "set_param_float", real, value)
    assert table[real] == value
    await flight.call_fails("DOES_NOT_EXIST", "param", "get_param_int", "NO_SUCH_NAME")


async def check_files(flight, folder: str, local) -> None:
    content = bytes(range(256)) * 40 + b"end"
    (local / "up.bin").write_bytes(content)
    await transfer(flight, "upload_async", str(local / "up.bin"), folder)
    listed = await flight.call("ftp", "list_directory", folder)
    assert ("up.bin", len(content)) in [(each["name"], each["size_bytes"]) for each in listed["entries"]]
    (local / "down").mkdir()
    for burst in (True, False):
        await transfer(flight, "download_async", f"{folder}/up.bin", str(local / "down"), burst)
        assert (local / "down" / "up.bin").read_bytes() == content
        (local / "down" / "up.bin").unlink()
    assert await flight.call("ftp", "are_files_identical", str(local / "up.bin"), f"{folder}/up.bin")
    await flight.call_ok("ftp", "create_directory", f"{folder}/new")
    await flight.call_ok("ftp", "rename", f"{folder}/up.bin", f"{folder}/new/other.bin")
    await flight.call_ok("ftp", "remove_file", f"{folder}/new/other.bin")
    await flight.call_ok("ftp", "remove_directory", f"{folder}/new")
    await flight.call_fails("FILE_DOES_NOT_EXIST", "ftp", "remove_file", f"{folder}/up.bin")


async def transfer(flight, method: str, *arguments) -> None:
    steps = await flight.ground.stream("ftp", method, *arguments)
    assert (await steps.wait_for(lambda update: update[0] != "NEXT"))[0] == "SUCCESS"


@pytest.mark.parametrize("firmware", FIRMWARES)
async def test_a_mission_and_its_log(firmware: str, tmp_path) -> None:
    async with simulated_flight("copter", firmware) as flight:
        await flight.wait_for_telemetry("health_all_ok", True)
        await flight.call_fails("NO_LOGFILES", "log_files", "get_entries")
        await check_fences(flight, firmware)
        await fly_mission(flight, firmware)
        await flight.wait_until(lambda: not flight.vehicle.storage.logs.writing)
        await check_logs(flight, tmp_path)


async def check_fences(flight, firmware: str) -> None:
    corners = [flight.place(north, east) for north, east in ((-90, -90), (90, -90), (90, 90), (-90, 90))]
    points = [
        mavsdk_object("geofence.Point", latitude_deg=latitude, longitude_deg=longitude)
        for latitude, longitude, _ in corners
    ]
    tower = mavsdk_object(
        "geofence.Point", latitude_deg=flight.place(0, 60)[0], longitude_deg=flight.place(0, 60)[1]
    )
    fence = mavsdk_object(
        "geofence.GeofenceData",
        polygons=[mavsdk_object("geofence.Polygon", points=points, fence_type=0)],
        circles=[mavsdk_object("geofence.Circle", point=tower, radius=8.0, fence_type=1)],
    )
    with flight.real_time():
        await flight.call_ok("geofence", "upload_geofence", fence)
    returned = await flight.call("geofence", "download_geofence")
    assert len(returned["polygons"][0]["points"]) == 4
    assert returned["circles"][0]["radius"] == 8.0
    if firmware == "ardupilot":
        await flight.call_ok("param", "set_param_int", "FENCE_ENABLE", 1)
        await flight.call_ok("param", "set_param_int", "FENCE_TYPE", 4)


async def fly_mission(flight, firmware: str) -> None:
    """A mission of MAVSDK's own item type."""
    first = {"vehicle_action": 1} if firmware == "px4" else {}  # ArduPilot's item 0 is home
    items = [
        item(flight, 0, 0, 10, **first),
        item(flight, 60, 0, 12, speed_m_s=6.0),
        item(flight, 60, 20, 14, is_fly_through=False, loiter_time_s=3.0),
        item(flight, 0, 20, 10, yaw_deg=180.0),
    ]
    await flight.call_ok("mission", "set_return_to_launch_after_mission", False)
    with flight.real_time():
        await flight.call_ok(
            "mission", "upload_mission", mavsdk_object("mission.MissionPlan", mission_items=items)
        )
    returned = await flight.call("mission_raw", "download_mission")
    assert [each["command"] for each in returned] == [
        CMD.NAV_TAKEOFF if firmware == "px4" else CMD.NAV_WAYPOINT,
        CMD.NAV_WAYPOINT,
        CMD.DO_CHANGE_SPEED,
        CMD.NAV_WAYPOINT,
        CMD.NAV_DELAY,
        CMD.NAV_WAYPOINT,
    ]
    if firmware == "px4":  # MAVSDK cannot read the frame of ArduPilot's home
        assert len((await flight.call("mission", "download_mission"))["mission_items"]) == 4
    progress = await flight.ground.stream("mission", "subscribe_mission_progress")
    await begin_mission(flight, firmware)
    await progress.wait_for(lambda update: update["current"] == 1)
    await flight.call_ok("mission", "pause_mission")
    await flight.wait_until(lambda: flight.speed < 0.6)
    assert flight.distance(60, 0) > 5
    await flight.call_ok("mission", "start_mission")
    await progress.wait_for(lambda update: update["current"] == 2)
    assert flight.vehicle.body.truth.north > 30
    await progress.wait_for(lambda update: update["current"] == 3)
    await flight.wait_until(lambda: flight.distance(0, 20) < 5)
    await progress.wait_for(lambda update: update["current"] == update["total"] == 4)
    assert await flight.call("mission", "is_mission_finished")
    await flight.call_ok("action", "land")
    await flight.wait_until(lambda: not flight.vehicle.autopilot.armed)


async def begin_mission(flight, firmware: str) -> None:
    """PX4 takes off by its first item; MAVSDK cannot send ArduPilot a takeoff item."""
    if firmware == "px4":
        await flight.call_ok("action", "arm")
    else:
        await flight.call_fails("FAILED", "action", "takeoff")
        await flight.call_ok("action", "arm")
        await flight.call_ok("action", "takeoff")
        await flight.wait_until(lambda: flight.height > 2)
    await flight.call_ok("mission", "start_mission")
    await flight.wait_for_telemetry("flight_mode", "MISSION")


def item(flight, north: float, east: float, height: float, **fields) -> dict:
    latitude, longitude, _ = flight.place(north, east)
    return mavsdk_object(
        "mission.MissionItem",
        latitude_deg=latitude,
        longitude_deg=longitude,
        relative_altitude_m=float(height),
        **{"is_fly_through": True, **fields},
    )


async def check_logs(flight, local) -> None:
    """The downloaded log equals the log file on the vehicle."""
    logs = flight.vehicle.storage.logs
    entries = await flight.call("log_files", "get_entries")
    assert [entry["size_bytes"] for entry in entries] == [each.size for each in logs.logs()]
    for entry, each in zip(entries, logs.logs(), strict=True):
        saved, log_entry = local / f"log{entry['id']}", mavsdk_object("log_files.Entry", **entry)
        steps = await flight.ground.stream("log_files", "download_log_file_async", log_entry, str(saved))
        assert (await steps.wait_for(lambda update: update[0] != "NEXT"))[0] == "SUCCESS"
        assert saved.read_bytes() == content_of(logs, each.id, each.size)
        assert saved.stat().st_size > 10_000
    await flight.call_ok("log_files", "erase_all_log_files")
    await flight.wait_until(lambda: not logs.logs())


def content_of(logs, number: int, size: int) -> bytes:
    content = b""
    while len(content) < size:
        content += logs.read(number, len(content), size)
    return content
