"""A simulated vehicle on a bus in memory: topics, services, actions, and what is refused."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any

import pytest

from mavstack.bridges.core.bridge import Bridge
from mavstack.bridges.core.types import codec_of
from mavstack.dialects import common
from mavstack.security.roles import Role
from mavstack.sim.vehicle_types import VehicleType
from tests.bridges.core.memory_sink import MemorySink
from tests.vehicle.world import ARDUPILOT, PX4, World, fly, kind_name

if TYPE_CHECKING:
    from mavstack.vehicle import Vehicle

COPTER = (VehicleType.COPTER, ARDUPILOT)
PX4_COPTER = (VehicleType.COPTER, PX4)
GUIDED = {ARDUPILOT: "GUIDED", PX4: "AUTO.LOITER"}


def bridge(world: World, sink: MemorySink, role: Role = Role.ADMINISTER, **options: Any) -> Bridge:
    return Bridge(world.node, [sink], role=role, **options)


@pytest.mark.parametrize("kind", [COPTER, PX4_COPTER], ids=kind_name)
def test_topics_of_a_standing_vehicle(kind: Any) -> None:
    async def scenario(world: World, vehicle: Vehicle) -> None:
        sink = MemorySink()
        await vehicle.get_position()
        async with bridge(world, sink):
            await asyncio.sleep(5)
            state = sink.last("/mavros/state")
            assert (state["connected"], state["armed"]) == (True, False)
            fix = sink.last("/mavros/global_position/global")
            assert fix["latitude"] == pytest.approx(vehicle.position.latitude, abs=1e-6)
            assert fix["altitude"] == pytest.approx(vehicle.position.altitude + 47.3, abs=1.0)
            imu = sink.last("/mavros/imu/data")
            assert imu["header"]["frame_id"] == "base_link"
            assert imu["linear_acceleration"]["z"] == pytest.approx(9.8, abs=0.5)
            assert sink.last("/mavros/battery")["percentage"] > 0.5
            names = [status["name"] for status in sink.last("/diagnostics")["status"]]
            assert "mavlink 1: heartbeat" in names
            frames = [each["child_frame_id"] for each in sink.last("/tf_static")["transforms"]]
            assert frames == ["map_ned", "odom_ned", "base_link_frd"]
        assert not sink.is_open

    fly(kind, scenario)


@pytest.mark.parametrize("kind", [COPTER, PX4_COPTER], ids=kind_name)
def test_services_and_actions_fly(kind: Any) -> None:
    async def scenario(world: World, vehicle: Vehicle) -> None:
        sink = MemorySink("/mavros/action/goto/_action/feedback")
        await vehicle.get_position()
        async with bridge(world, sink):
            mode = GUIDED[kind[1]]
            assert await sink.call("/mavros/set_mode", custom_mode=mode) == {"mode_sent": True}
            armed = await sink.call("/mavros/cmd/arming", value=True)
            assert armed == {"success": True, "result": 0}
            home = vehicle.position.altitude if kind[1] is PX4 else 0.0
            assert (await sink.call("/mavros/cmd/takeoff", altitude=home + 10))["success"]
            await world.wait_until(lambda: (vehicle.position.relative_altitude or 0) > 9)
            goal = {"latitude": vehicle.position.latitude + 2e-4, "longitude": vehicle.position.longitude}
            goal |= {"altitude": 12.0, "yaw": float("nan")}
            uid = {"uuid": bytes(range(16))}
            sent = await sink.call("/mavros/action/goto/_action/send_goal", goal_id=uid, goal=goal)
            assert sent["accepted"]
            result = await sink.call("/mavros/action/goto/_action/get_result", goal_id=uid)
            assert result == {"status": 4, "result": {"success": True, "reason": ""}}
            feedback = sink.last("/mavros/action/goto/_action/feedback")
            assert feedback["feedback"]["distance"] < 5
            assert vehicle.position.relative_altitude == pytest.approx(12, abs=0.7)

    fly(kind, scenario)


def test_a_refusal_has_the_reason_of_the_vehicle() -> None:
    async def scenario(world: World, vehicle: Vehicle) -> None:
        sink = MemorySink("/mavros/reason")
        async with bridge(world, sink):
            answer = await sink.call("/mavros/cmd/arming", value=True)
            assert answer == {"success": False, "result": int(common.MavResult.FAILED)}
            reason = sink.last("/mavros/reason")["data"]
            assert reason.startswith("/mavros/cmd/arming: arming 1/1 failed: FAILED (")
            trigger = await sink.call("/mavros/arm")
            assert trigger["success"] is False
            assert "1/1 failed" in trigger["message"]
            uid = {"uuid": bytes(16)}
            await sink.call("/mavros/action/takeoff/_action/send_goal", goal_id=uid, goal={"altitude": 5.0})
            result = await sink.call("/mavros/action/takeoff/_action/get_result", goal_id=uid)
            assert result["status"] == 6
            assert "not armed" in result["result"]["reason"]

    fly(COPTER, scenario, ready=False)


def test_a_cancelled_goal_holds_the_vehicle() -> None:
    async def scenario(world: World, vehicle: Vehicle) -> None:
        sink = MemorySink()
        await vehicle.get_position()
        async with bridge(world, sink):
            await vehicle.set_mode("GUIDED")
            await vehicle.arm()
            await vehicle.takeoff(10)
            goal = {"latitude": vehicle.position.latitude + 5e-3, "longitude": vehicle.position.longitude}
            goal |= {"altitude": 12.0, "yaw": float("nan")}
            uid = {"uuid": b"\1" * 16}
            await sink.call("/mavros/action/goto/_action/send_goal", goal_id=uid, goal=goal)
            await asyncio.sleep(2)
            cancel = await sink.call("/mavros/action/goto/_action/cancel_goal", goal_info={"goal_id": uid})
            assert cancel["return_code"] == 0
            assert len(cancel["goals_canceling"]) == 1
            result = await sink.call("/mavros/action/goto/_action/get_result", goal_id=uid)
            assert result["status"] == 5
            assert vehicle.mode in ("BRAKE", "LOITER", "POSHOLD")
            status = sink.last("/mavros/action/goto/_action/status")["status_list"]
            assert [each["status"] for each in status] == [5]

    fly(COPTER, scenario)


def test_without_permission_nothing_reaches_the_vehicle() -> None:
    async def scenario(world: World, vehicle: Vehicle) -> None:
        sink = MemorySink("/mavros/reason")
        async with bridge(world, sink, Role.OBSERVE):
            assert sink.inlets == {}
            assert (await sink.call("/mavros/cmd/arming", value=True))["success"] is False
            assert "--allow-control" in sink.last("/mavros/reason")["data"]
            assert (await sink.call("/mavros/mission/clear"))["success"] is False
            uid = {"uuid": bytes(16)}
            sent = await sink.call("/mavros/action/land/_action/send_goal", goal_id=uid)
            assert sent["accepted"] is False
            assert (await sink.call("/mavros/mission/pull"))["success"] is True
        assert vehicle.armed is False

    fly(COPTER, scenario)


def test_an_operator_changes_no_parameters() -> None:
    async def scenario(world: World, vehicle: Vehicle) -> None:
        sink = MemorySink()
        async with bridge(world, sink, Role.OPERATE):
            value = {"type": 2, "integer_value": 7}
            answer = await sink.call("/mavros/param/set", param_id="SYSID_THISMAV", value=value)
            assert answer["success"] is False
            assert "/mavros/setpoint_raw/local" in sink.inlets
            assert "/mavros/mavlink_sink" not in sink.inlets

    fly(COPTER, scenario)


def test_missions_and_parameters() -> None:
    async def scenario(world: World, vehicle: Vehicle) -> None:
        sink = MemorySink()
        await vehicle.get_position()
        async with bridge(world, sink):
            place = vehicle.position
            items = [
                {"frame": 3, "command": 22, "autocontinue": True, "z_alt": 10.0},
                {
                    "frame": 3,
                    "command": 16,
                    "autocontinue": True,
                    "x_lat": place.latitude + 1e-3,
                    "y_long": place.longitude,
                    "z_alt": 20.0,
                },
                {"frame": 2, "command": 20, "autocontinue": True},
            ]
            pushed = await sink.call("/mavros/mission/push", waypoints=[items[0], *items])
            assert pushed == {"success": True, "wp_transfered": 4}
            listed = sink.last("/mavros/mission/waypoints")["waypoints"]
            assert [item["command"] for item in listed][1:] == [22, 16, 20]
            changed = await sink.call("/mavros/mission/push", start_index=2, waypoints=[items[1]])
            assert changed == {"success": True, "wp_transfered": 1}
            assert (await sink.call("/mavros/mission/pull"))["wp_received"] == 4
            value = {"type": 3, "double_value": 1500.0}
            done = await sink.call("/mavros/param/set", param_id="RTL_ALT", value=value)
            assert done["success"] is True
            names = ["RTL_ALT", "NONSENSE"]
            got = await sink.call("/mavros/param/get_parameters", names=names)
            assert got["values"][0]["integer_value"] or got["values"][0]["double_value"] == 1500.0
            assert got["values"][1]["type"] == 0
            assert sink.last("/mavros/param/event")["param_id"] == "RTL_ALT"

    fly(COPTER, scenario)


def test_files() -> None:
    async def scenario(world: World, vehicle: Vehicle) -> None:
        sink = MemorySink()
        await vehicle.get_position()
        async with bridge(world, sink):
            path = "/APM/note.txt"
            assert (await sink.call("/mavros/ftp/open", file_path=path, mode=2))["success"]
            assert (await sink.call("/mavros/ftp/write", file_path=path, offset=2, data=b"llo"))["success"]
            assert (await sink.call("/mavros/ftp/write", file_path=path, offset=0, data=b"he"))["success"]
            assert (await sink.call("/mavros/ftp/close", file_path=path))["success"]
            read = await sink.call("/mavros/ftp/read", file_path=path, offset=1, size=3)
            assert read["data"] == b"ell"
            missing = await sink.call("/mavros/ftp/remove", file_path="/APM/nonsense")
            assert (missing["success"], missing["r_errno"]) == (False, 2)

    fly(COPTER, scenario)


def test_several_vehicles_have_names_and_frames() -> None:
    async def scenario(world: World, vehicle: Vehicle) -> None:
        await world.node.wait_for_vehicles(2)
        sink = MemorySink()
        async with bridge(world, sink, vehicle_names={2: "beta"}):
            await asyncio.sleep(3)
            assert {"/uav1/mavros/state", "/beta/mavros/state"} <= set(sink.topics)
            frame = sink.last("/beta/mavros/imu/data")["header"]["frame_id"]
            assert frame == "beta/base_link"
            assert "/beta/mavros/param" in sink.nodes

    fly([COPTER, PX4_COPTER], scenario)


def test_a_topic_without_subscribers_is_not_converted() -> None:
    async def scenario(world: World, vehicle: Vehicle) -> None:
        sink = MemorySink("/mavros/imu/data")
        await vehicle.get_position()
        async with bridge(world, sink):
            await asyncio.sleep(3)
            published = {name for name, topic in sink.topics.items() if topic.published}
            assert "/mavros/imu/data" in published
            assert "/mavros/local_position/pose" not in published
            sink.subscribe("/mavros/local_position/pose")
            await asyncio.sleep(3)
            assert sink.topics["/mavros/local_position/pose"].published

    fly(COPTER, scenario)


def test_packets_pass_in_both_directions() -> None:
    async def scenario(world: World, vehicle: Vehicle) -> None:
        sink = MemorySink("/mavros/mavlink_source")
        await vehicle.get_position()
        async with bridge(world, sink):
            await asyncio.sleep(3)
            fields = sink.last("/mavros/mavlink_source")
            assert (fields["magic"], fields["sysid"]) == (0xFD, 1)
            packet = dict(fields)
            assert sink.inlets["/mavros/mavlink_sink"].receive_fields(packet)
            packet["checksum"] ^= 1
            assert not sink.inlets["/mavros/mavlink_sink"].receive_fields(packet)

    fly(COPTER, scenario)


def test_an_old_setpoint_is_refused_and_counted() -> None:
    async def scenario(world: World, vehicle: Vehicle) -> None:
        import time

        sink = MemorySink()
        await vehicle.get_position()
        async with bridge(world, sink):
            inlet = sink.inlets["/mavros/setpoint_velocity/cmd_vel"]
            codec = codec_of(inlet.type)
            now = time.time_ns() // 1_000_000_000
            header = {"stamp": {"sec": now - 2}, "frame_id": "map"}
            assert not inlet.receive(codec.encode_fields({"header": header}))
            assert "old by its header" in inlet.last_reason
            header["stamp"] = {"sec": 0}
            assert inlet.receive(codec.encode_fields({"header": header}))
            header["frame_id"] = "camera"
            assert not inlet.receive(codec.encode_fields({"header": header}))
            assert not inlet.receive(b"nonsense")
            assert (inlet.accepted, inlet.refused) == (1, 3)

    fly(COPTER, scenario)


def test_a_setpoint_that_the_network_held_back_is_refused() -> None:
    """Its type has no header, so that only the publisher's time shows its age."""

    async def scenario(world: World, vehicle: Vehicle) -> None:
        import time

        sink = MemorySink()
        await vehicle.get_position()
        async with bridge(world, sink):
            inlet = sink.inlets["/mavros/setpoint_velocity/cmd_vel_unstamped"]
            sample = codec_of(inlet.type).encode_fields({})
            ahead = time.time_ns() + 3_600_000_000_000  # the publisher's clock is wrong by an hour
            assert inlet.receive(sample, "script", ahead)
            assert not inlet.receive(sample, "script", ahead - 600_000_000)
            assert inlet.last_reason.startswith("the sample arrived 0.6 s later than others of its publisher")
            assert inlet.receive(sample, "script", ahead - 300_000_000)
            assert inlet.receive(sample, "another", ahead - 600_000_000)
            assert inlet.receive(sample, "script", 0)
            states = sink.inlets["/mavros/statustext/send"]
            text = codec_of(states.type).encode_fields({"text": "hello"})
            assert states.receive(text, "script", ahead)
            assert states.receive(text, "script", ahead - 5_000_000_000)

    fly(COPTER, scenario)
