"""pymavlink's `mavutil`, `mavparm`, `mavwp` and `mavftp` against the service servers."""

from __future__ import annotations

import struct

import pytest
from pymavlink import mavftp, mavparm, mavwp
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from mavstack.dialects import common
from mavstack.services.mission import PlanType
from tests.interop.pymavlink_peer import in_thread, receive
from tests.interop.vehicle import vehicle_on_udp

pytestmark = pytest.mark.interop

PX4, ARDUPILOT = common.MavAutopilot.PX4, common.MavAutopilot.ARDUPILOTMEGA


@pytest.mark.parametrize(
    ("autopilot", "name", "number"), [(PX4, "RTL", 0x05040000), (ARDUPILOT, "GUIDED", 4)]
)
async def test_heartbeat_and_modes(autopilot: int, name: str, number: int) -> None:
    def work(connection):
        assert connection.target_system == 1
        assert name in connection.mode_mapping()
        connection.set_mode(name)
        assert receive(connection, "COMMAND_ACK").result == mavlink.MAV_RESULT_ACCEPTED
        receive(connection, "HEARTBEAT", lambda heartbeat: heartbeat.custom_mode == number)
        return connection.flightmode

    async with vehicle_on_udp(autopilot=autopilot) as (vehicle, port):
        assert await in_thread(port, work) == name
        assert vehicle.modes.current.custom_mode == number


@pytest.mark.parametrize("autopilot", [PX4, ARDUPILOT])
async def test_parameters(autopilot: int) -> None:
    bytewise = autopilot == PX4

    def number(message) -> float:
        if bytewise and message.param_type == mavlink.MAV_PARAM_TYPE_INT32:
            return struct.unpack("<i", struct.pack("<f", message.param_value))[0]
        return message.param_value

    def work(connection):
        connection.param_fetch_all()
        values = {}
        while len(values) < 44:
            message = receive(connection, "PARAM_VALUE")
            if message.param_id != "_HASH_CHECK":
                assert message.param_count == 44
                values[message.param_id] = number(message)
        connection.param_fetch_one("GAIN")
        single = receive(connection, "PARAM_VALUE", lambda message: message.param_id == "GAIN")
        assert single.param_value == pytest.approx(-0.123)
        assert mavparm.MAVParmDict().mavset(
            connection, "GAIN", 0.75, parm_type=mavlink.MAV_PARAM_TYPE_REAL32, retries=20
        )
        if not bytewise:
            assert mavparm.MAVParmDict().mavset(connection, "NEGATIVE", -12, retries=20)
        connection.param_fetch_one("NOPE")
        error = receive(connection, "PARAM_ERROR")
        assert (error.param_id, error.error) == ("NOPE", common.MavParamError.DOES_NOT_EXIST)
        return values

    async with vehicle_on_udp(autopilot=autopilot) as (vehicle, port):
        expected = {definition.name: definition.value for definition in vehicle.parameters.table}
        assert await in_thread(port, work) == pytest.approx(expected)
        assert vehicle.parameters["GAIN"] == 0.75
        assert vehicle.parameters["NEGATIVE"] == (-7 if bytewise else -12)


def waypoints(connection, number: int, kind: type, command: int, plan: int):
    loader = mavwp.MAVWPLoader(1, 1)
    for seq in range(number):
        loader.add(
            kind(
                1,
                1,
                seq,
                mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT,
                command,
                0,
                1,
                float(number) if plan == PlanType.FENCE else 0.5,
                *(0, 0, 0),
                *(
                    (473_977_415 + seq, 85_455_941)
                    if kind is mavlink.MAVLink_mission_item_int_message
                    else (47.5, 8.5)
                ),
                20.0 + seq,
                plan,
            )
        )
    return loader


def upload(connection, loader, plan: int):
    connection.mav.mission_count_send(1, 1, loader.count(), plan)
    while True:
        message = receive(connection, ["MISSION_REQUEST_INT", "MISSION_REQUEST", "MISSION_ACK"])
        if message.get_type() == "MISSION_ACK":
            return message
        assert message.mission_type == plan
        connection.mav.send(loader.wp(message.seq))


def download(connection, plan: int, *, as_int: bool = True):
    connection.mav.mission_request_list_send(1, 1, plan)
    count = receive(connection, "MISSION_COUNT").count
    ask = connection.mav.mission_request_int_send if as_int else connection.mav.mission_request_send
    items = []
    for seq in range(count):
        ask(1, 1, seq, plan)
        items.append(
            receive(connection, ["MISSION_ITEM_INT", "MISSION_ITEM"], lambda item, seq=seq: item.seq == seq)
        )
    connection.mav.mission_ack_send(1, 1, mavlink.MAV_MISSION_ACCEPTED, plan)
    return items


PLANS = [
    (PlanType.MISSION, mavlink.MAV_CMD_NAV_WAYPOINT),
    (PlanType.FENCE, mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION),
    (PlanType.RALLY, mavlink.MAV_CMD_NAV_RALLY_POINT),
]


@pytest.mark.parametrize(("plan", "command"), PLANS)
async def test_plans(plan: int, command: int) -> None:
    def work(connection):
        loader = waypoints(connection, 12, mavlink.MAVLink_mission_item_int_message, command, plan)
        ack = upload(connection, loader, plan)
        assert (ack.type, ack.mission_type) == (mavlink.MAV_MISSION_ACCEPTED, plan)
        for as_int in (True, False):
            items = download(connection, plan, as_int=as_int)
            assert [(item.x, item.y, item.z, item.param1, item.command) for item in items] == [
                (item.x, item.y, item.z, item.param1, item.command) for item in loader.wpoints
            ]
        if plan == PlanType.MISSION:
            connection.waypoint_set_current_send(5)
            receive(connection, "MISSION_CURRENT", lambda current: current.seq == 5)
        held = len(download(connection, plan))
        connection.mav.mission_clear_all_send(1, 1, plan)
        assert receive(connection, "MISSION_ACK").type == mavlink.MAV_MISSION_ACCEPTED
        assert download(connection, plan) == []
        return held

    async with vehicle_on_udp() as (vehicle, port):
        assert await in_thread(port, work) == 12
        assert len(vehicle.mission.plan(plan)) == 0


async def test_an_upload_by_mission_request() -> None:
    def work(connection):
        loader = waypoints(
            connection,
            3,
            mavlink.MAVLink_mission_item_message,
            mavlink.MAV_CMD_NAV_WAYPOINT,
            PlanType.MISSION,
        )
        return upload(connection, loader, PlanType.MISSION).type

    async with vehicle_on_udp() as (vehicle, port):
        assert await in_thread(port, work) == mavlink.MAV_MISSION_ACCEPTED
        items = vehicle.mission.plan(PlanType.MISSION).items
        assert [(item.param5, item.param6, item.param7) for item in items] == [
            (47.5, 8.5, 20.0),
            (47.5, 8.5, 21.0),
            (47.5, 8.5, 22.0),
        ]


@pytest.mark.smoke
async def test_commands() -> None:
    def work(connection):
        def ask(command: int, *params: float):
            params = (*params, *(0.0,) * (7 - len(params)))
            connection.mav.command_long_send(1, 1, command, 0, *params)
            return receive(connection, "COMMAND_ACK", lambda ack: ack.command == command).result

        assert ask(mavlink.MAV_CMD_NAV_TAKEOFF) == mavlink.MAV_RESULT_TEMPORARILY_REJECTED
        connection.arducopter_arm()
        connection.motors_armed_wait()
        assert ask(mavlink.MAV_CMD_NAV_TAKEOFF, *(0,) * 6, 30.0) == mavlink.MAV_RESULT_ACCEPTED
        assert ask(mavlink.MAV_CMD_NAV_LAND) == mavlink.MAV_RESULT_ACCEPTED
        connection.arducopter_disarm()
        connection.motors_disarmed_wait()
        home = mavlink.MAV_CMD_DO_SET_HOME
        connection.mav.command_int_send(1, 1, 5, home, 0, 0, 0, 0, 0, 0, 473_977_415, 85_455_941, 5.0)
        assert receive(connection, "COMMAND_ACK", lambda ack: ack.command == home).result == 0
        assert ask(mavlink.MAV_CMD_DO_PARACHUTE, 1) == mavlink.MAV_RESULT_UNSUPPORTED
        calibrate = mavlink.MAV_CMD_PREFLIGHT_CALIBRATION
        assert ask(calibrate, 1) == mavlink.MAV_RESULT_IN_PROGRESS
        receive(connection, "COMMAND_ACK", lambda ack: ack.result == mavlink.MAV_RESULT_ACCEPTED)

    async with vehicle_on_udp() as (vehicle, port):
        await in_thread(port, work)
        assert [request.command.param7 for request in vehicle.takeoffs] == [30.0]
        assert not vehicle.is_armed


async def test_telemetry_texts_and_rates() -> None:
    async with vehicle_on_udp() as (vehicle, port):

        def work(connection):
            place = connection.location()
            assert (place.lat, place.lng) == pytest.approx((47.3977415, 8.5455941))
            assert receive(connection, "STATUSTEXT").text == "hello there"
            attitude = mavlink.MAVLINK_MSG_ID_ATTITUDE
            connection.mav.command_long_send(
                1, 1, mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, 0, attitude, 5_000, 0, 0, 0, 0, 0
            )
            assert receive(connection, "COMMAND_ACK").result == mavlink.MAV_RESULT_ACCEPTED
            connection.mav.command_long_send(
                1, 1, mavlink.MAV_CMD_GET_MESSAGE_INTERVAL, 0, attitude, 0, 0, 0, 0, 0, 0
            )
            interval = receive(connection, "MESSAGE_INTERVAL")
            assert (interval.message_id, interval.interval_us) == (attitude, 5_000)
            connection.mav.command_long_send(
                1,
                1,
                mavlink.MAV_CMD_REQUEST_MESSAGE,
                0,
                mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION,
                0,
                0,
                0,
                0,
                0,
                0,
            )
            return receive(connection, "AUTOPILOT_VERSION").capabilities

        def text(now: float) -> common.Statustext:
            return common.Statustext(text="hello there")

        vehicle.publish(common.Statustext, text, interval=0.3)
        assert await in_thread(port, work) == vehicle.capabilities


def runner(connection):
    """Return a function that runs `mavftp` commands; most of them end by an idle timeout."""
    files = mavftp.MAVFTP(connection, 1, 1)
    files.ftp_settings.idle_detection_time = 2.0

    def run(*arguments: str):
        result = files.cmd_ftp(list(arguments))
        if arguments[0] in ("get", "put"):
            result = files.process_ftp_reply(arguments[0], timeout=60)
        return result.error_code

    return files, run


GOOD = mavftp.FtpError.Success


async def test_files(tmp_path) -> None:
    root, local = tmp_path / "root", tmp_path / "local"
    root.mkdir()
    local.mkdir()
    content = bytes(range(256)) * 200 + b"end"
    (root / "flight.bin").write_bytes(content)
    (local / "up.bin").write_bytes(content[::-1])

    def work(connection):
        files, run = runner(connection)
        assert run("list", "/") == GOOD
        assert [(entry.name, entry.size_b, entry.is_dir) for entry in files.list_result] == [
            ("flight.bin", len(content), False)
        ]
        assert run("get", "/flight.bin", str(local / "flight.bin")) == GOOD
        assert run("put", str(local / "up.bin"), "/up.bin") == GOOD
        assert run("crc", "/up.bin") == GOOD
        assert run("get", "/nothing", str(local / "nothing")) == mavftp.FtpError.FileNotFound

    async with vehicle_on_udp(root=root) as (vehicle, port):
        await in_thread(port, work)
        assert len(vehicle.ftp.sessions) == 0
    assert (local / "flight.bin").read_bytes() == content
    assert (root / "up.bin").read_bytes() == content[::-1]


async def test_the_file_tree(tmp_path) -> None:
    (tmp_path / "a.txt").write_bytes(b"a")

    def work(connection):
        _, run = runner(connection)
        assert run("mkdir", "/new") == GOOD
        assert run("mkdir", "/new") == mavftp.FtpError.FileExists
        assert run("rename", "/a.txt", "/new/b.txt") == GOOD
        assert (tmp_path / "new" / "b.txt").read_bytes() == b"a"
        assert run("rm", "/new/b.txt") == GOOD
        assert run("rmdir", "/new") == GOOD

    async with vehicle_on_udp(root=tmp_path) as (_, port):
        await in_thread(port, work)
    assert list(tmp_path.iterdir()) == []


async def test_packed_parameters(tmp_path) -> None:
    saved = tmp_path / "parameters.txt"

    def work(connection):
        files = mavftp.MAVFTP(connection, 1, 1)
        files.cmd_getparams([str(saved)])
        return files.process_ftp_reply("GetParams", timeout=60).error_code

    async with vehicle_on_udp(autopilot=ARDUPILOT) as (vehicle, port):
        assert await in_thread(port, work) == mavftp.FtpError.Success
        expected = {definition.name: definition.value for definition in vehicle.parameters.table}
    lines = [line.replace(",", " ").split() for line in saved.read_text().splitlines()]
    assert {name: float(value) for name, value in lines} == pytest.approx(expected)
