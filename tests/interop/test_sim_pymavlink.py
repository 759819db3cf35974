"""Typical pymavlink scripts against simulated vehicles in a background thread."""

from __future__ import annotations

import time
from contextlib import closing, contextmanager
from math import cos, hypot, radians
from typing import TYPE_CHECKING

import pytest
from pymavlink import mavftp, mavparm, mavutil, mavwp
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavstack.sim.background import BackgroundSimulator
from tests.interop.pymavlink_peer import TIMEOUT, receive, send_heartbeat

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = pytest.mark.interop

SPEED = 6.0
ACCEPTED = mavlink.MAV_RESULT_ACCEPTED
MISSION = mavlink.MAV_MISSION_TYPE_MISSION
#: Values of POSITION_TARGET_TYPEMASK: positions only, velocities only.
POSITIONS, VELOCITIES = 0b110111111000, 0b110111000111


@contextmanager
def script(kind: str, firmware: str = "ardupilot", **parameters):
    """Yield a simulated vehicle and a mavutil connection that has received its heartbeat."""
    simulated = BackgroundSimulator(kind, firmware, speed=SPEED)
    for name, value in parameters.items():
        simulated.vehicle.parameters.set(name, value)
    with simulated, closing(mavutil.mavlink_connection(simulated.url)) as connection:
        limit_waiting(connection)
        send_heartbeat(connection)
        assert connection.wait_heartbeat(timeout=TIMEOUT) is not None
        yield simulated.vehicle, connection


def limit_waiting(connection) -> None:
    """Make `recv_match` fail instead of waiting for ever."""
    end, receive_any = time.monotonic() + 3 * TIMEOUT, connection.recv_match

    def recv_match(condition=None, type=None, blocking=False, timeout=None):  # noqa: A002 (its name for it)
        message = receive_any(condition, type, blocking, timeout or TIMEOUT)
        timed_out = message is None and blocking and timeout is None
        assert not timed_out, f"no {type} with {condition}"
        assert time.monotonic() < end, f"still waiting for {type} with {condition}"
        return message

    connection.recv_match = recv_match


def wait_for_ack(connection, command: int) -> int:
    """Return the result of a command, after any IN_PROGRESS."""
    done = lambda ack: ack.command == command and ack.result != mavlink.MAV_RESULT_IN_PROGRESS  # noqa: E731
    return receive(connection, "COMMAND_ACK", done).result


def send_command(connection, command: int, *params: float) -> int:
    connection.mav.command_long_send(1, 1, command, 0, *(*params, *[0] * 7)[:7])
    return wait_for_ack(connection, command)


def set_mode(connection, name: str) -> None:
    connection.set_mode(name)
    assert wait_for_ack(connection, mavlink.MAV_CMD_DO_SET_MODE) == ACCEPTED
    receive(connection, "HEARTBEAT", lambda beat: mavutil.mode_string_v10(beat) == name)
    assert connection.flightmode == name


def wait_for_altitude(connection, metres: float) -> None:
    receive(connection, "GLOBAL_POSITION_INT", lambda here: abs(here.relative_alt / 1000 - metres) < 1)


def wait_for_position(connection, north: float, east: float, radius: float = 1.5) -> None:
    receive(connection, "LOCAL_POSITION_NED", lambda here: hypot(here.x - north, here.y - east) < radius)


def place(vehicle, north: float, east: float) -> tuple[float, float]:
    return vehicle.body.frame.to_global(north, east, 0)[:2]


@pytest.mark.long
def test_a_script_flies_a_copter() -> None:
    with script("copter") as (vehicle, connection):
        check_telemetry(vehicle, connection)
        check_parameters(vehicle, connection)
        check_modes(vehicle, connection)
        take_off(vehicle, connection)
        fly_setpoints(vehicle, connection)
        fly_guided_waypoints(vehicle, connection)
        fly_by_rc_override(vehicle, connection)
        return_to_launch(vehicle, connection)


def check_telemetry(vehicle, connection) -> None:
    assert connection.target_system == 1
    assert connection.field("HEARTBEAT", "autopilot") == mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA
    connection.wait_gps_fix()
    here = connection.location()
    assert (here.lat, here.lng) == pytest.approx(place(vehicle, 0, 0), abs=5e-5)
    assert here.alt == pytest.approx(488, abs=3)
    assert connection.location(relative_alt=True).alt == pytest.approx(0, abs=3)
    assert connection.time_since("HEARTBEAT") < TIMEOUT
    connection.mav.request_data_stream_send(1, 1, mavlink.MAV_DATA_STREAM_EXTRA1, 10, 1)
    times = [receive(connection, "ATTITUDE").time_boot_ms for _ in range(12)][2:]
    assert (times[-1] - times[0]) / 9 == pytest.approx(100, abs=15)
    assert (
        send_command(connection, mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, mavlink.MAVLINK_MSG_ID_ATTITUDE, 5e5)
        == ACCEPTED
    )
    times = [receive(connection, "ATTITUDE").time_boot_ms for _ in range(6)][2:]
    assert (times[-1] - times[0]) / 3 == pytest.approx(500, abs=50)
    version = mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION
    connection.mav.command_long_send(1, 1, mavlink.MAV_CMD_REQUEST_MESSAGE, 0, version, 0, 0, 0, 0, 0, 0)
    assert receive(connection, "AUTOPILOT_VERSION").capabilities & mavlink.MAV_PROTOCOL_CAPABILITY_FTP
    assert connection.packet_loss() < 50


def check_parameters(vehicle, connection) -> None:
    deadline = time.monotonic() + 3 * TIMEOUT
    while len(connection.params) < len(vehicle.parameters):
        assert time.monotonic() < deadline, f"only {len(connection.params)} parameters"
        if connection.recv_match(type="PARAM_VALUE", blocking=True, timeout=2) is None:
            connection.param_fetch_all()  # the first time, and if a busy machine lost some
    assert connection.params["WPNAV_SPEED"] == 1000
    connection.param_set_send("WPNAV_SPEED", 800)
    receive(
        connection, "PARAM_VALUE", lambda value: (value.param_id, value.param_value) == ("WPNAV_SPEED", 800)
    )
    connection.param_fetch_one("WPNAV_SPEED")
    assert receive(connection, "PARAM_VALUE").param_value == connection.param("WPNAV_SPEED") == 800
    assert mavparm.MAVParmDict().mavset(connection, "RTL_ALT", 1500, retries=20)
    assert vehicle.parameters["RTL_ALT"] == 1500


def check_modes(vehicle, connection) -> None:
    modes = connection.mode_mapping()
    assert modes["GUIDED"] == 4
    for name in ("ALT_HOLD", "LOITER"):
        set_mode(connection, name)
    connection.set_mode_apm("STABILIZE")
    connection.recv_match(type="HEARTBEAT", blocking=True, condition="HEARTBEAT.custom_mode==0")
    connection.mav.set_mode_send(1, mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED, modes["GUIDED"])
    connection.recv_match(type="HEARTBEAT", blocking=True, condition="HEARTBEAT.custom_mode==4")


def take_off(vehicle, connection) -> None:
    connection.arducopter_arm()
    connection.motors_armed_wait()
    assert send_command(connection, mavlink.MAV_CMD_NAV_TAKEOFF, 0, 0, 0, 0, 0, 0, 10) == ACCEPTED
    wait_for_altitude(connection, 10)
    connection.recv_match(
        condition="VFR_HUD.climb<0.3 and GLOBAL_POSITION_INT.relative_alt>9000", blocking=True
    )


def fly_setpoints(vehicle, connection) -> None:
    local, none = mavlink.MAV_FRAME_LOCAL_NED, (0, 0, 0)
    send = connection.mav.set_position_target_local_ned_send
    send(0, 1, 1, local, POSITIONS, 12, -5, -14, *none, *none, 0, 0)
    wait_for_position(connection, 12, -5)
    wait_for_altitude(connection, 14)
    for _ in range(3):
        send(0, 1, 1, local, VELOCITIES, *none, -2, 1, 0, *none, 0, 0)
        moving = receive(connection, "LOCAL_POSITION_NED", lambda here: here.vx < -1.7)
    assert moving.vy == pytest.approx(1, abs=0.3)
    latitude, longitude = place(vehicle, 0, 0)
    connection.mav.set_position_target_global_int_send(
        *(0, 1, 1, mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT, POSITIONS),
        *(round(latitude * 1e7), round(longitude * 1e7), 10, *none, *none, 0, 0),
    )
    wait_for_position(connection, 0, 0)
    half = radians(5)  # of ten degrees to the right
    aim = [cos(half), 0.087, 0, 0]

    def rolls(attitude) -> bool:
        connection.mav.set_attitude_target_send(0, 1, 1, 0b111, aim, 0, 0, 0, 0.5)
        return attitude.roll > radians(8)

    receive(connection, "ATTITUDE", rolls)
    assert vehicle.autopilot.armed


def fly_guided_waypoints(vehicle, connection) -> None:
    """DroneKit's `simple_goto` (a guided mission item), and DO_REPOSITION."""
    latitude, longitude = place(vehicle, 15, 5)
    frame, waypoint = mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT, mavlink.MAV_CMD_NAV_WAYPOINT
    connection.mav.mission_item_send(1, 1, 0, frame, waypoint, 2, 0, 0, 0, 0, 0, latitude, longitude, 15)
    assert receive(connection, "MISSION_ACK").type == mavlink.MAV_MISSION_ACCEPTED
    wait_for_position(connection, 15, 5)
    latitude, longitude = place(vehicle, -5, 5)
    connection.mav.command_int_send(
        *(1, 1, mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT, mavlink.MAV_CMD_DO_REPOSITION, 0, 0, -1, 1, 0, 0),
        *(round(latitude * 1e7), round(longitude * 1e7), 12),
    )
    assert wait_for_ack(connection, mavlink.MAV_CMD_DO_REPOSITION) == ACCEPTED
    wait_for_position(connection, -5, 5)
    assert send_command(connection, mavlink.MAV_CMD_CONDITION_YAW, 180, 60, 1, 0) == ACCEPTED
    receive(connection, "VFR_HUD", lambda hud: abs(hud.heading - 180) < 5)


def fly_by_rc_override(vehicle, connection) -> None:
    release = [0] * 8
    override = connection.mav.rc_channels_override_send
    override(1, 1, 1500, 1500, 1500, 1500, 0, 0, 0, 0)
    receive(connection, "RC_CHANNELS", lambda channels: channels.chan3_raw == 1500)
    connection.set_mode_loiter()
    receive(connection, "HEARTBEAT", lambda beat: beat.custom_mode == 5)

    def override_and_check(here) -> bool:
        override(1, 1, 1500, 1300, 1500, 1500, 0, 0, 0, 0)
        return here.vx < -1.5  # forward, while the copter faces south

    receive(connection, "LOCAL_POSITION_NED", override_and_check)
    override(1, 1, *release)
    connection.set_servo(9, 1800)
    assert wait_for_ack(connection, mavlink.MAV_CMD_DO_SET_SERVO) == ACCEPTED
    receive(connection, "SERVO_OUTPUT_RAW", lambda servos: servos.servo9_raw == 1800)


def return_to_launch(vehicle, connection) -> None:
    connection.set_mode_rtl()
    connection.motors_disarmed_wait()
    assert connection.flightmode == "RTL"
    here = vehicle.body.truth
    assert hypot(here.north, here.east) < 2
    connection.reboot_autopilot()
    assert wait_for_ack(connection, mavlink.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN) == ACCEPTED
    receive(connection, "STATUSTEXT", lambda text: text.text == "ArduPilot Ready")
    receive(connection, "HEARTBEAT", lambda beat: beat.custom_mode == 0)
    assert vehicle.boots == 2


def upload(connection, loader: mavwp.MAVWPLoader) -> int:
    """Upload as pymavlink's examples do: an item for each MISSION_REQUEST."""
    connection.waypoint_clear_all_send()
    assert receive(connection, "MISSION_ACK").type == mavlink.MAV_MISSION_ACCEPTED
    connection.waypoint_count_send(loader.count())
    for _ in range(loader.count()):
        request = connection.recv_match(type=["MISSION_REQUEST"], blocking=True)
        connection.mav.send(loader.wp(request.seq))
    return receive(connection, "MISSION_ACK").type


def test_a_script_flies_a_mission_with_a_copter(tmp_path) -> None:
    with script("copter") as (vehicle, connection):
        loader = mavwp.MAVWPLoader(1, 1)
        loader.add_latlonalt(*place(vehicle, 0, 0), 0)
        loader.add(
            mavlink.MAVLink_mission_item_message(
                1, 1, 1, mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT, mavlink.MAV_CMD_NAV_TAKEOFF, 0, 1, *[0] * 6, 8
            )
        )
        for point in ((20, 0), (20, 15)):
            loader.add_latlonalt(*place(vehicle, *point), 10)
        assert upload(connection, loader) == mavlink.MAV_MISSION_ACCEPTED
        check_download(connection, loader)
        connection.wait_gps_fix()
        connection.set_mode("GUIDED")
        connection.arducopter_arm()
        connection.motors_armed_wait()
        connection.set_mode_auto()
        assert wait_for_ack(connection, mavlink.MAV_CMD_MISSION_START) == ACCEPTED
        reached = [receive(connection, "MISSION_ITEM_REACHED").seq for _ in range(2)]
        assert reached in ([1, 2], [2, 3])
        connection.waypoint_set_current_send(2)
        receive(connection, "MISSION_CURRENT", lambda current: current.seq == 2)
        assert connection.waypoint_current() in (2, 3)  # it may have reached item 2 meanwhile
        receive(connection, "MISSION_CURRENT", lambda current: current.seq == 3)
        wait_for_position(connection, 20, 15)
        set_mode(connection, "LAND")
        connection.motors_disarmed_wait()
        download_files(vehicle, connection, tmp_path)


def check_download(connection, loader: mavwp.MAVWPLoader) -> None:
    connection.waypoint_request_list_send()
    assert receive(connection, "MISSION_COUNT").count == loader.count()
    for seq in range(1, loader.count()):
        connection.waypoint_request_send(seq)
        item = connection.recv_match(type=["MISSION_ITEM"], blocking=True, timeout=TIMEOUT)
        expected = loader.wp(seq)
        assert (item.seq, item.command, item.z) == (seq, expected.command, expected.z)
        assert (item.x, item.y) == pytest.approx((expected.x, expected.y), abs=1e-5)


def download_files(vehicle, connection, directory: Path) -> None:
    """Download the parameters and the flight log by `mavftp`."""
    ftp = mavftp.MAVFTP(connection, target_system=1, target_component=1)
    assert ftp.cmd_list(["/APM/LOGS"]).error_code == mavftp.FtpError.Success
    assert "00000001.BIN" in [entry.name for entry in ftp.list_result]
    assert ftp.cmd_getparams([str(directory / "all.parm")]).error_code == mavftp.FtpError.Success
    assert ftp.process_ftp_reply("getparams", timeout=TIMEOUT).error_code == mavftp.FtpError.Success
    lines = (directory / "all.parm").read_text().splitlines()
    assert len(lines) == len(vehicle.parameters)
    assert (
        ftp.cmd_get(["/APM/LOGS/00000001.BIN", str(directory / "log.bin")]).error_code
        == mavftp.FtpError.Success
    )
    assert ftp.process_ftp_reply("OpenFileRO", timeout=TIMEOUT).error_code == mavftp.FtpError.Success
    store = vehicle.storage.logs
    assert (directory / "log.bin").read_bytes() == store.read(1, 0, store.logs()[0].size)


def test_a_script_flies_px4() -> None:
    with script("copter", "px4", COM_DL_LOSS_T=60) as (vehicle, connection):
        assert connection.mode_mapping() == mavutil.px4_map
        connection.wait_gps_fix()
        connection.set_mode_px4("LOITER", 0, 0)
        assert wait_for_ack(connection, mavlink.MAV_CMD_DO_SET_MODE) == ACCEPTED
        connection.arducopter_arm()
        connection.motors_armed_wait()
        set_mode(connection, "TAKEOFF")
        wait_for_altitude(connection, 2.5)
        receive(connection, "HEARTBEAT", lambda beat: mavutil.mode_string_v10(beat) == "LOITER")
        fly_offboard(connection)
        set_mode(connection, "POSCTL") if vehicle.autopilot.radio.present else set_mode(connection, "LOITER")
        set_mode(connection, "RTL")
        connection.motors_disarmed_wait()
        connection.param_fetch_one("MIS_TAKEOFF_ALT")
        assert receive(connection, "PARAM_VALUE").param_value == pytest.approx(2.5)
        assert send_command(connection, mavlink.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1) == ACCEPTED


def fly_offboard(connection) -> None:
    """Stream setpoints before entering offboard mode and while in it."""

    def send() -> None:
        connection.mav.set_position_target_local_ned_send(
            *(0, 1, 1, mavlink.MAV_FRAME_LOCAL_NED, POSITIONS, 8, 4, -6, *[0] * 6, 0, 0)
        )

    for _ in range(10):
        send()
        time.sleep(0.3 / SPEED)
    connection.set_mode("OFFBOARD")
    arrived = False
    deadline = time.monotonic() + TIMEOUT
    while not arrived and time.monotonic() < deadline:
        send()
        here = connection.recv_match(type="LOCAL_POSITION_NED", blocking=True, timeout=0.3 / SPEED)
        arrived = here is not None and hypot(here.x - 8, here.y - 4) < 1 and abs(here.z + 6) < 1
    assert arrived
    assert connection.flightmode == "OFFBOARD"


def test_a_script_drives_a_rover() -> None:
    with script("rover") as (vehicle, connection):
        connection.wait_gps_fix()
        set_mode(connection, "GUIDED")
        connection.arducopter_arm()
        connection.motors_armed_wait()
        send = connection.mav.set_position_target_local_ned_send
        send(0, 1, 1, mavlink.MAV_FRAME_LOCAL_NED, POSITIONS, 10, 10, 0, *[0] * 6, 0, 0)
        wait_for_position(connection, 10, 10, radius=2.5)
        set_mode(connection, "HOLD")
        connection.arducopter_disarm()
        connection.motors_disarmed_wait()
        assert not vehicle.autopilot.armed
