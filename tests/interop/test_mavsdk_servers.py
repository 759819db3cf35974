"""MAVSDK's server plugins against the service clients."""

from __future__ import annotations

import asyncio
import json
from contextlib import asynccontextmanager

import pytest

from mavstack.dialects import common
from mavstack.errors import CommandDenied, CommandTimeout, FileDenied, FileTimeout, ParameterDenied
from mavstack.links import open_link
from mavstack.node import Node
from mavstack.services.mission import MissionItem, Plan, PlanType
from tests.interop.mavsdk_peer import mavsdk_object, mavsdk_peer, needs_mavsdk

pytestmark = [pytest.mark.interop, needs_mavsdk]


@asynccontextmanager
async def remote_and_server():
    """Yield the remote component and the MAVSDK server that is behind it."""
    link = open_link("udpin://127.0.0.1:0")
    async with (
        Node(link) as node,
        mavsdk_peer(f"udpout://127.0.0.1:{link.address[1]}", "server", 1, 1) as server,
    ):
        yield await node.wait_for_autopilot(), server


async def test_the_server_is_found() -> None:
    async with remote_and_server() as (remote, server):
        assert remote.address == (1, 1)
        await server.call("action_server", "set_armable", True, False)
        version = await remote.get_version()
        assert version.can(common.MavProtocolCapability.MAVLINK2)
        assert (await remote.ping(1)).sent == 1


async def test_parameters() -> None:
    async with remote_and_server() as (remote, server):
        await server.call("param_server", "provide_param_int", "LARGE", (1 << 31) - 1)
        await server.call("param_server", "provide_param_int", "NEGATIVE", -7)
        await server.call("param_server", "provide_param_float", "GAIN", -0.25)
        for number in range(60):
            await server.call("param_server", "provide_param_int", f"P_{number}", number)
        changes = await server.stream("param_server", "subscribe_changed_param_int")
        assert (await remote.params.get("LARGE")).value == (1 << 31) - 1
        fetched = await remote.params.download()
        expected = {"LARGE": (1 << 31) - 1, "NEGATIVE": -7, "GAIN": -0.25, **{f"P_{n}": n for n in range(60)}}
        assert {name: parameter.value for name, parameter in fetched.items()} == expected
        assert (await remote.params.set("NEGATIVE", -1_000_001)).value == -1_000_001
        assert await changes.get() == {"name": "NEGATIVE", "value": -1_000_001}
        assert (await remote.params.set("GAIN", 0.5)).value == 0.5
        assert await server.call("param_server", "retrieve_param_float", "GAIN") == 0.5
        with pytest.raises(ParameterDenied, match="DOES_NOT_EXIST"):
            await remote.params.get("NOPE")


def plan(number: int, kind: int = PlanType.MISSION) -> Plan:
    commands = {
        PlanType.MISSION: common.MavCmd.NAV_WAYPOINT,
        PlanType.FENCE: common.MavCmd.NAV_FENCE_POLYGON_VERTEX_INCLUSION,
        PlanType.RALLY: common.MavCmd.NAV_RALLY_POINT,
    }
    items = [
        MissionItem(
            commands[kind],  # type: ignore[index]
            param1=float(number) if kind == PlanType.FENCE else 1.5,
            param5=47.3977415 + seq / 1e4,
            param6=-8.5455941,
            param7=20.5 + seq,
        )
        for seq in range(number)
    ]
    return Plan.of(items, kind)


@pytest.mark.parametrize(
    ("kind", "part"), [(PlanType.MISSION, "mission"), (PlanType.FENCE, "fence"), (PlanType.RALLY, "rally")]
)
async def test_plans(kind: int, part: str) -> None:
    async with remote_and_server() as (remote, server):
        incoming = await server.stream("mission_raw_server", "subscribe_incoming_mission")
        cleared = await server.stream("mission_raw_server", "subscribe_clear_all")
        plans, sent = getattr(remote, part), plan(100, kind)
        await plans.upload(sent)
        result, received = await incoming.get()
        assert result == "SUCCESS"
        assert [item["seq"] for item in received["mission_items"]] == list(range(100))
        assert received["mission_items"][3]["x"] == 473_980_415
        assert await plans.download() == sent
        await plans.clear()
        assert await cleared.get() == kind
        assert len(await plans.download()) == 0


async def test_the_current_item() -> None:
    async with remote_and_server() as (remote, server):
        changed = await server.stream("mission_raw_server", "subscribe_current_item_changed")
        await remote.mission.upload(plan(5))
        await changed.wait_for(lambda item: item["seq"] == 0)
        await remote.mission.set_current(3)
        await changed.wait_for(lambda item: item["seq"] == 3)


async def test_files(tmp_path) -> None:
    content = bytes(range(256)) * 300 + b"end"
    (tmp_path / "flight.ulg").write_bytes(content)
    (tmp_path / "empty.txt").write_bytes(b"")
    (tmp_path / "logs").mkdir()
    async with remote_and_server() as (remote, server):
        await server.call("ftp_server", "set_root_dir", str(tmp_path))
        files = remote.ftp
        listed = {entry.name: entry for entry in await files.list("/")}
        assert sorted(listed) == ["empty.txt", "flight.ulg", "logs"]
        assert listed["flight.ulg"].size == len(content)
        assert await files.download("/flight.ulg") == content
        assert await files.download("/empty.txt") == b""
        assert await files.download("/flight.ulg", offset=1000, size=700) == content[1000:1700]
        await files.upload("/logs/up.bin", content[::-1])
        assert (tmp_path / "logs" / "up.bin").read_bytes() == content[::-1]
        await files.upload("/logs/up.bin", b"shorter now")
        assert (tmp_path / "logs" / "up.bin").read_bytes() == b"shorter now"
        await files.rename("/logs/up.bin", "/moved.bin")
        with pytest.raises(FileTimeout):  # MAVSDK 4.1 neither carries TRUNCATEFILE out nor refuses it
            await files.truncate("/moved.bin", 7, timeout=0.5)
        await files.remove("/moved.bin")
        await files.make_directory("/new")
        with pytest.raises(FileDenied):
            await files.make_directory("/new")
        await files.remove_directory("/new")
        with pytest.raises(FileDenied):
            await files.download("/nothing")
        assert sorted(each.name for each in tmp_path.iterdir()) == ["empty.txt", "flight.ulg", "logs"]


async def test_actions() -> None:
    async with remote_and_server() as (remote, server):
        arms = await server.stream("action_server", "subscribe_arm_disarm")
        takeoffs = await server.stream("action_server", "subscribe_takeoff")
        with pytest.raises(CommandDenied, match="TEMPORARILY_REJECTED"):
            await remote.command(common.MavCmd.COMPONENT_ARM_DISARM, 1)
        assert (await arms.get())[0] == "COMMAND_DENIED"
        await server.call("action_server", "set_armable", True, True)
        await server.call("action_server", "set_allow_takeoff", True)
        await remote.command(common.MavCmd.COMPONENT_ARM_DISARM, 1)
        assert await arms.get() == ("SUCCESS", {"arm": True, "force": False})
        await remote.command(common.MavCmd.NAV_TAKEOFF, 0, 0, 0, 0, 0, 0, 20)
        assert await takeoffs.get() == ("SUCCESS", True)
        with pytest.raises(CommandTimeout):  # MAVSDK 4.1 does not answer commands that it does not know
            await remote.command(common.MavCmd.DO_PARACHUTE, 1, timeout=0.5)


TELEMETRY = {
    common.GlobalPositionInt: (
        "publish_position",
        [
            mavsdk_object(
                "telemetry_server.Position",
                latitude_deg=47.3977415,
                longitude_deg=8.5455941,
                absolute_altitude_m=488.5,
                relative_altitude_m=12.25,
            ),
            mavsdk_object("telemetry_server.VelocityNed", north_m_s=1.5, east_m_s=-2.5, down_m_s=-0.5),
            mavsdk_object("telemetry_server.Heading", heading_deg=90.0),
        ],
        {"relative_alt": 12_250, "alt": 488_500, "vx": 150, "vy": -250, "vz": -50, "hdg": 9_000},
    ),
    common.BatteryStatus: (
        "publish_battery",
        # MAVSDK 4.1 calls this a percentage, but it is a fraction.
        [mavsdk_object("telemetry_server.Battery", voltage_v=12.4, remaining_percent=0.87)],
        {"battery_remaining": 87},
    ),
    common.ExtendedSysState: (
        "publish_extended_sys_state",
        [0, 2],
        {"landed_state": common.MavLandedState.IN_AIR},
    ),
    common.Attitude: (
        "publish_attitude",
        [
            mavsdk_object("telemetry_server.EulerAngle", roll_deg=90.0, pitch_deg=0.0, yaw_deg=-90.0),
            mavsdk_object(
                "telemetry_server.AngularVelocityBody", roll_rad_s=0.25, pitch_rad_s=0.5, yaw_rad_s=-0.5
            ),
        ],
        {"roll": 1.5707964, "yaw": -1.5707964, "rollspeed": 0.25},
    ),
    common.Statustext: (
        "publish_status_text",
        [mavsdk_object("telemetry_server.StatusText", type=4, text="Ready to fly")],
        {"text": "Ready to fly"},
    ),
}


@pytest.mark.parametrize("kind", TELEMETRY, ids=lambda kind: kind.__name__)
async def test_telemetry(kind: type) -> None:
    method, arguments, expected = TELEMETRY[kind]  # type: ignore[index]
    async with remote_and_server() as (remote, server), remote.stream(kind) as received:
        assert await server.call("telemetry_server", method, *arguments) == "SUCCESS"
        message = await anext(received)
        assert {name: getattr(message, name) for name in expected} == pytest.approx(expected)


async def test_a_mode() -> None:
    async with remote_and_server() as (remote, server), remote.stream(common.Heartbeat) as beats:
        changes = await server.stream("action_server", "subscribe_flight_mode_change")
        allowed = mavsdk_object("action_server.AllowableFlightModes", can_auto_rtl_mode=True)
        await server.call("action_server", "set_allowable_flight_modes", allowed)
        custom = common.MavModeFlag.CUSTOM_MODE_ENABLED
        await remote.command(common.MavCmd.DO_SET_MODE, custom, 4, 5)
        assert await changes.get() == ("SUCCESS", "RETURN_TO_LAUNCH")
        with pytest.raises(CommandDenied, match="TEMPORARILY_REJECTED"):
            await remote.command(common.MavCmd.DO_SET_MODE, custom, 4, 6)
        async for beat in beats:
            if beat.custom_mode == 0x05040000:
                break


async def test_extended_parameters() -> None:
    async with remote_and_server() as (remote, server):
        await server.call("param_server", "provide_param_custom", "CAMERA", "a text of its own")
        await server.call("param_server", "provide_param_int", "COUNT", -5)
        await server.call("param_server", "provide_param_float", "GAIN", 0.25)
        changed = await server.stream("param_server", "subscribe_changed_param_custom")
        parameters = remote.extended_params
        fetched = await parameters.download()
        assert {name: parameter.value for name, parameter in fetched.items()} == {
            "CAMERA": "a text of its own",
            "COUNT": -5,
            "GAIN": 0.25,
        }
        assert (await parameters.set("CAMERA", "another")).value == "another"
        assert await changed.get() == {"name": "CAMERA", "value": "another"}


async def test_concurrent_clients() -> None:
    async with remote_and_server() as (remote, server):
        await server.call("action_server", "set_disarmable", True, True)
        incoming = await server.stream("mission_raw_server", "subscribe_incoming_mission")
        for number in range(30):
            await server.call("param_server", "provide_param_int", f"P_{number}", number)
        fetched, _, version, _ = await asyncio.gather(
            remote.params.download(),
            remote.mission.upload(plan(50)),
            remote.get_version(),
            remote.command(common.MavCmd.COMPONENT_ARM_DISARM, 0),
        )
        assert len(fetched) == 30
        assert (await incoming.get())[0] == "SUCCESS"
        assert version.can(common.MavProtocolCapability.MAVLINK2)
        assert len(await remote.mission.download()) == 50


async def test_metadata() -> None:
    """MAVSDK's component metadata server: our client reads the description of a parameter from it."""
    async with remote_and_server() as (remote, server):
        await server.call("param_server", "provide_param_int", "LARGE", 7)
        described = {"name": "LARGE", "type": "Int32", "shortDesc": "A large one", "min": -5, "max": 9}
        document = json.dumps({"version": 1, "parameters": [described]})
        parameters = mavsdk_object("component_metadata_server.Metadata", type=0, json_metadata=document)
        await server.call("component_metadata_server", "set_metadata", [parameters])
        found = await remote.params.download_metadata()
        assert (found["LARGE"].short_description, found["LARGE"].maximum) == ("A large one", 9)
        assert remote.params.metadata.problem("LARGE", 10) == "10 is outside of its range -5 to 9"
