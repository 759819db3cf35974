"""MAVSDK asks our simulated vehicles for all that they hold: telemetry, parameters, files, logs, plans."""

from __future__ import annotations

from functools import partial

import pytest

from mavstack.dialects import common
from tests.interop.mavsdk_peer import made, needs_mavsdk
from tests.interop.simulated import in_flight

pytestmark = [pytest.mark.interop, needs_mavsdk]

CMD = common.MavCmd
FIRMWARES = ("ardupilot", "px4")


def near(name: str, wanted: float, within: float):
    return lambda heard: heard[name] == pytest.approx(wanted, abs=within)


def at_rest(imu: dict, gravity: float = 9.81) -> bool:
    return imu["acceleration_frd"]["down_m_s2"] == pytest.approx(-gravity, rel=0.05)


#: What a copter on its field says of itself, by kind of telemetry.
BOTH = {
    "position": near("relative_altitude_m", 0, 1),
    "home": near("absolute_altitude_m", 488, 1),
    "in_air": lambda heard: heard is False,
    "landed_state": lambda heard: heard == "ON_GROUND",
    "armed": lambda heard: heard is False,
    "vtol_state": lambda heard: heard == "UNDEFINED",
    "attitude_quaternion": near("w", 1, 0.01),
    "attitude_euler": near("roll_deg", 0, 1),
    "attitude_angular_velocity_body": near("roll_rad_s", 0, 0.1),
    "velocity_ned": near("north_m_s", 0, 0.5),
    "gps_info": lambda heard: heard == {"num_satellites": 14, "fix_type": "FIX_3D"},
    "raw_gps": near("latitude_deg", 47.3977, 1e-3),
    "battery": near("remaining_percent", 100, 1),
    "flight_mode": lambda heard: heard in ("HOLD", "STABILIZED"),
    "health": lambda heard: all(heard.values()),
    "health_all_ok": lambda heard: heard is True,
    "position_velocity_ned": lambda heard: abs(heard["position"]["down_m"]) < 1,
    "fixedwing_metrics": near("groundspeed_m_s", 0, 0.5),
    "imu": at_rest,
    "scaled_imu": at_rest,
    "raw_imu": partial(at_rest, gravity=1000),
    "unix_epoch_time": lambda heard: heard > 1_767_225_600_000_000,
    "scaled_pressure": near("absolute_pressure_hpa", 956, 1),
    "distance_sensor": near("current_distance_m", 0, 0.2),
    "heading": lambda heard: min(heard["heading_deg"], 360 - heard["heading_deg"]) < 3,
}
ONLY = {
    "ardupilot": {"rc_status": lambda heard: heard["is_available"]},
    "px4": {
        "rc_status": lambda heard: not heard["is_available"],
        "odometry": lambda heard: abs(heard["position_body"]["z_m"]) < 1,
        "altitude": near("altitude_amsl_m", 488, 1),
        "actuator_output_status": lambda heard: heard["actuator"][0] == -1,
        "ground_truth": near("absolute_altitude_m", 488, 0.1),
    },
}
#: What no rate can be set for: they come with something else.
WITHOUT_RATE = {"armed", "flight_mode", "health_all_ok", "heading", "scaled_pressure"}
WITHOUT_RATE |= {"attitude_angular_velocity_body", "wind"}
#: With a rangefinder, which ArduPilot has only if its parameters say so.
FITTED = {"ardupilot": {"RNGFND1_TYPE": 100}, "px4": {}}


@pytest.mark.parametrize("firmware", FIRMWARES)
async def test_telemetry(firmware: str) -> None:
    wanted = BOTH | ONLY[firmware]
    async with in_flight("copter", firmware, **FITTED[firmware]) as flight:
        await flight.hears("health_all_ok", True)
        for name in wanted.keys() - WITHOUT_RATE:
            await flight.does("telemetry", f"set_rate_{name}", 5.0)
        for name, condition in wanted.items():
            await flight.hears(name, condition)
        origin = await flight.call("telemetry", "get_gps_global_origin")
        assert origin["latitude_deg"] == pytest.approx(47.3977418)
        await flight.refuses("COMMAND_DENIED", "telemetry", "set_rate_actuator_control_target", 5.0)
        await rates(flight)
        await information(flight, firmware)


async def rates(flight) -> None:
    """A rate is as it was set: in simulated time."""
    await flight.does("telemetry", "set_rate_attitude_euler", 2.0)
    heard = await flight.ground.stream("telemetry", "subscribe_attitude_euler")
    first = await heard.get()
    times = [(await heard.get())["timestamp_us"] for _ in range(5)]
    assert times[0] > first["timestamp_us"]
    assert (times[4] - times[0]) / 4e6 == pytest.approx(0.5, abs=0.05)


async def information(flight, firmware: str) -> None:
    version = await flight.call("info", "get_version")
    assert version["flight_sw_major"] == {"ardupilot": 4, "px4": 1}[firmware]
    assert version["flight_sw_version_type"] == "RELEASE"
    identification = await flight.call("info", "get_identification")
    assert int(identification["hardware_uid"].rstrip("\0"), 16)
    assert await flight.call("info", "get_product")
    flown = await flight.ground.stream("info", "subscribe_flight_information")
    await flown.until(lambda heard: heard["time_boot_ms"] > 0 and heard["duration_since_arming_ms"] == 0)
    # The speed factor, which MAVSDK 4.1 would find out by itself, it always calls NaN.


@pytest.mark.parametrize("firmware", FIRMWARES)
async def test_parameters_and_files(firmware: str, tmp_path) -> None:
    async with in_flight("copter", firmware) as flight:
        await parameters(
            flight,
            *{
                "ardupilot": ("RTL_ALT", "WPNAV_SPEED", 750.0),
                "px4": ("COM_RC_IN_MODE", "MPC_XY_CRUISE", 6.5),
            }[firmware],
        )
        await files(flight, {"ardupilot": "/APM/scripts", "px4": "/fs/microsd/etc"}[firmware], tmp_path)


async def parameters(flight, whole: str, real: str, value: float) -> None:
    table = flight.vehicle.parameters
    every = await flight.call("param", "get_all_params")
    heard = {each["name"]: each["value"] for kind in ("int_params", "float_params") for each in every[kind]}
    names = {name for name in heard if name != "_HASH_CHECK"}
    assert names == {each.name for each in table.table}
    assert len(names) > 300
    assert {name: heard[name] for name in names} == pytest.approx({name: table[name] for name in names})
    assert await flight.call("param", "get_param_int", whole) == table[whole]
    await flight.does("param", "set_param_float", real, value)
    assert table[real] == value
    await flight.refuses("DOES_NOT_EXIST", "param", "get_param_int", "NO_SUCH_NAME")


async def files(flight, folder: str, local) -> None:
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
    await flight.does("ftp", "create_directory", f"{folder}/new")
    await flight.does("ftp", "rename", f"{folder}/up.bin", f"{folder}/new/other.bin")
    await flight.does("ftp", "remove_file", f"{folder}/new/other.bin")
    await flight.does("ftp", "remove_directory", f"{folder}/new")
    await flight.refuses("FILE_DOES_NOT_EXIST", "ftp", "remove_file", f"{folder}/up.bin")


async def transfer(flight, method: str, *arguments) -> None:
    steps = await flight.ground.stream("ftp", method, *arguments)
    assert (await steps.until(lambda heard: heard[0] != "NEXT"))[0] == "SUCCESS"


@pytest.mark.parametrize("firmware", FIRMWARES)
async def test_a_mission_and_its_log(firmware: str, tmp_path) -> None:
    async with in_flight("copter", firmware) as flight:
        await flight.hears("health_all_ok", True)
        await flight.refuses("NO_LOGFILES", "log_files", "get_entries")
        await fences(flight, firmware)
        await a_mission(flight, firmware)
        await flight.until(lambda: not flight.vehicle.storage.logs.writing)
        await logs(flight, tmp_path)


async def fences(flight, firmware: str) -> None:
    corners = [flight.place(north, east) for north, east in ((-90, -90), (90, -90), (90, 90), (-90, 90))]
    points = [
        made("geofence.Point", latitude_deg=latitude, longitude_deg=longitude)
        for latitude, longitude, _ in corners
    ]
    tower = made("geofence.Point", latitude_deg=flight.place(0, 60)[0], longitude_deg=flight.place(0, 60)[1])
    fence = made(
        "geofence.GeofenceData",
        polygons=[made("geofence.Polygon", points=points, fence_type=0)],
        circles=[made("geofence.Circle", point=tower, radius=8.0, fence_type=1)],
    )
    with flight.by_the_clock():
        await flight.does("geofence", "upload_geofence", fence)
    returned = await flight.call("geofence", "download_geofence")
    assert len(returned["polygons"][0]["points"]) == 4
    assert returned["circles"][0]["radius"] == 8.0
    if firmware == "ardupilot":
        await flight.does("param", "set_param_int", "FENCE_ENABLE", 1)
        await flight.does("param", "set_param_int", "FENCE_TYPE", 4)


async def a_mission(flight, firmware: str) -> None:
    """Of MAVSDK's own items."""
    first = {"vehicle_action": 1} if firmware == "px4" else {}  # ArduPilot's item 0 is home
    items = [
        item(flight, 0, 0, 10, **first),
        item(flight, 60, 0, 12, speed_m_s=6.0),
        item(flight, 60, 20, 14, is_fly_through=False, loiter_time_s=3.0),
        item(flight, 0, 20, 10, yaw_deg=180.0),
    ]
    await flight.does("mission", "set_return_to_launch_after_mission", False)
    with flight.by_the_clock():
        await flight.does("mission", "upload_mission", made("mission.MissionPlan", mission_items=items))
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
    await begins(flight, firmware)
    await progress.until(lambda heard: heard["current"] == 1)
    await flight.does("mission", "pause_mission")
    await flight.until(lambda: flight.speed < 0.6)
    assert flight.distance(60, 0) > 5
    await flight.does("mission", "start_mission")
    await progress.until(lambda heard: heard["current"] == 2)
    assert flight.vehicle.body.truth.north > 30
    await progress.until(lambda heard: heard["current"] == 3)
    await flight.until(lambda: flight.distance(0, 20) < 5)
    await progress.until(lambda heard: heard["current"] == heard["total"] == 4)
    assert await flight.call("mission", "is_mission_finished")
    await flight.does("action", "land")
    await flight.until(lambda: not flight.vehicle.autopilot.armed)


async def begins(flight, firmware: str) -> None:
    """PX4 takes off by its first item; to ArduPilot MAVSDK cannot send one that does."""
    if firmware == "px4":
        await flight.does("action", "arm")
    else:
        await flight.refuses("FAILED", "action", "takeoff")
        await flight.does("action", "arm")
        await flight.does("action", "takeoff")
        await flight.until(lambda: flight.height > 2)
    await flight.does("mission", "start_mission")
    await flight.hears("flight_mode", "MISSION")


def item(flight, north: float, east: float, height: float, **fields) -> dict:
    latitude, longitude, _ = flight.place(north, east)
    return made(
        "mission.MissionItem",
        latitude_deg=latitude,
        longitude_deg=longitude,
        relative_altitude_m=float(height),
        **{"is_fly_through": True, **fields},
    )


async def logs(flight, local) -> None:
    """The log that begins at arming: as it lies on the vehicle's card."""
    kept = flight.vehicle.storage.logs
    entries = await flight.call("log_files", "get_entries")
    assert [entry["size_bytes"] for entry in entries] == [each.size for each in kept.logs()]
    for entry, each in zip(entries, kept.logs(), strict=True):
        saved, wanted = local / f"log{entry['id']}", made("log_files.Entry", **entry)
        steps = await flight.ground.stream("log_files", "download_log_file_async", wanted, str(saved))
        assert (await steps.until(lambda heard: heard[0] != "NEXT"))[0] == "SUCCESS"
        assert saved.read_bytes() == content_of(kept, each.id, each.size)
        assert saved.stat().st_size > 10_000
    await flight.does("log_files", "erase_all_log_files")
    await flight.until(lambda: not kept.logs())


def content_of(kept, number: int, size: int) -> bytes:
    content = b""
    while len(content) < size:
        content += kept.read(number, len(content), size)
    return content
