"""MAVSDK and MAVProxy with flight controllers of Betaflight and iNav over their bridge."""

from __future__ import annotations

from contextlib import asynccontextmanager

import pytest

from mavstack.bridges.msp.bridge import MspBridge
from mavstack.dialects import common
from mavstack.msp.messages.modes import BoxIds
from tests.bridges.msp.fake_controller import FakeController
from tests.interop.mavproxy import mavproxy, needs_mavproxy
from tests.interop.mavsdk_peer import MavsdkError, mavsdk_object, mavsdk_peer, needs_mavsdk

pytestmark = [pytest.mark.interop, pytest.mark.timeout(120)]

VARIANTS = ("BTFL", "INAV")
GLOBAL_RELATIVE, MISSION = int(common.MavFrame.GLOBAL_RELATIVE_ALT), int(common.MavFrame.MISSION)


@asynccontextmanager
async def bridge_on_udp(variant: str, scheme: str = "udpin"):
    """Yield a fake controller and the UDP port of its bridge."""
    controller = FakeController(variant)
    async with MspBridge(controller, f"{scheme}://127.0.0.1:0") as bridge:
        _, port = bridge.node.links[0].address
        yield controller, port


@asynccontextmanager
async def mavsdk_and_bridge(variant: str):
    async with (
        bridge_on_udp(variant) as (controller, port),
        mavsdk_peer(f"udpout://127.0.0.1:{port}") as ground,
    ):
        yield ground, controller


def item(seq: int, command: int, *params: float, frame: int = GLOBAL_RELATIVE) -> object:
    values = (*params, 0.0, 0.0, 0.0, 0.0)[:4]
    return mavsdk_object(
        "mission_raw.MissionItem",
        seq=seq,
        frame=frame,
        command=command,
        current=int(seq == 0),
        autocontinue=1,
        **{f"param{number}": float(value) for number, value in enumerate(values, 1)},
        x=470_000_000 + seq if frame == GLOBAL_RELATIVE else 0,
        y=80_000_000 if frame == GLOBAL_RELATIVE else 0,
        z=20.0 if frame == GLOBAL_RELATIVE else 0.0,
        mission_type=0,
    )


@needs_mavsdk
@pytest.mark.parametrize("variant", VARIANTS)
async def test_mavsdk_telemetry_and_arming(variant: str) -> None:
    async with mavsdk_and_bridge(variant) as (ground, controller):
        stream = await ground.stream("telemetry", "subscribe_attitude_euler")
        attitude = await stream.wait_for(lambda update: update["roll_deg"] == pytest.approx(10, abs=0.1))
        assert attitude["pitch_deg"] == pytest.approx(-20, abs=0.1)
        stream = await ground.stream("telemetry", "subscribe_position")
        position = await stream.get()
        assert position["latitude_deg"] == 47.0
        assert position["relative_altitude_m"] == pytest.approx(12.5)
        stream = await ground.stream("telemetry", "subscribe_battery")
        assert (await stream.get())["remaining_percent"] == 80
        assert await ground.call("action", "arm") == "SUCCESS"
        assert controller.armed
        assert await ground.call("action", "disarm") == "SUCCESS"
        assert not controller.armed


@needs_mavsdk
async def test_mavsdk_parameters() -> None:
    async with mavsdk_and_bridge("BTFL") as (ground, controller):
        assert await ground.call("param", "get_param_float", "BF_PID_ROLL_P") == 45
        assert await ground.call("param", "set_param_float", "BF_PID_ROLL_P", 50.0) == "SUCCESS"
        assert controller.settings.values["BF_PID_ROLL_P"] == 50
        with pytest.raises(MavsdkError, match="DOES_NOT_EXIST"):
            await ground.call("param", "get_param_float", "NOPE")
        every = await ground.call("param", "get_all_params")
        assert {each["name"] for each in every["float_params"]} >= {"BF_RC_EXPO", "MSP_HAS_VTX"}


@needs_mavsdk
async def test_mavsdk_mission_of_inav() -> None:
    async with mavsdk_and_bridge("INAV") as (ground, controller):
        items = [
            item(0, 16),
            item(1, 178, 1, 7.5, -1, frame=MISSION),
            item(2, 16),
            item(3, 20, frame=MISSION),
        ]
        assert await ground.call("mission_raw", "upload_mission", items) == "SUCCESS"
        assert [each.action for each in controller.waypoints.values()] == [1, 1, 4]
        downloaded = await ground.call("mission_raw", "download_mission")
        assert [each["command"] for each in downloaded] == [16, 178, 16, 20]


@needs_mavproxy
@pytest.mark.parametrize("variant", VARIANTS)
async def test_mavproxy(variant: str, tmp_path) -> None:
    async with (
        bridge_on_udp(variant, "tcpin") as (controller, port),
        mavproxy(port, tmp_path, transport="tcp") as console,
    ):
        await console.wait_for_output("Detected vehicle 1:1", "Received 6 parameters")
        await console.send_until_answered("param show BF_PID*", "BF_PID_ROLL_P    45")
        console.send_line("param set BF_PID_ROLL_P 51")
        await console.send_until_answered("param show BF_PID*", "BF_PID_ROLL_P    51")
        assert controller.settings.values["BF_PID_ROLL_P"] == 51
        console.send_line("arm throttle")
        # The heartbeat may tell it before the command is answered, until which another one is refused.
        await console.wait_for_output("COMPONENT_ARM_DISARM: ACCEPTED")
        if "ARMED" not in console.printed:
            await console.wait_for_output("ARMED")
        assert controller.armed
        console.send_line("disarm")
        await console.wait_for_output("DISARMED")
        controller.reasons = 1 << 8
        await console.wait_for_output("PreArm: not level")
        assert BoxIds in controller.polls
        assert console.errors() == []
