"""The topics of a simulated vehicle on MQTT, in virtual time and without a broker."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any

import pytest

from mavstack.bridges.mqtt import vehicle_topics
from mavstack.bridges.mqtt.broker import Broker
from mavstack.bridges.mqtt.vehicle_topics import MqttOptions, VehicleTopics
from mavstack.security.roles import Role
from mavstack.sim.vehicle_types import VehicleType
from tests.bridges.mqtt.memory_session import MemorySession
from tests.vehicle.world import ARDUPILOT, PX4, World, fly, kind_name

if TYPE_CHECKING:
    from mavstack.vehicle import Vehicle

COPTER = (VehicleType.COPTER, ARDUPILOT)
BROKER = Broker("127.0.0.1", 1883)


@pytest.fixture(autouse=True)
def without_broker(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(vehicle_topics, "Session", MemorySession)


async def opened(vehicle: Vehicle, **options: Any) -> tuple[VehicleTopics, MemorySession]:
    made = VehicleTopics(vehicle, "uav1", MqttOptions(BROKER, **options))
    await made.open()
    session: Any = made.session
    return made, session


@pytest.mark.parametrize("kind", [COPTER, (VehicleType.COPTER, PX4)], ids=kind_name)
def test_state_telemetry_and_events(kind: Any) -> None:
    async def scenario(world: World, vehicle: Vehicle) -> None:
        await vehicle.get_position()
        topics, session = await opened(vehicle, rate=5.0)
        assert session.will == "mavstack/uav1/status"
        assert session.all("mavstack/uav1/status") == ["online"]
        await asyncio.sleep(2.05)
        places = session.all("mavstack/uav1/telemetry/position")
        assert len(places) == 11
        assert places[-1]["latitude"] == pytest.approx(vehicle.position.latitude, abs=1e-6)
        for group in ("attitude", "speed", "battery", "gps"):
            assert len(session.all(f"mavstack/uav1/telemetry/{group}")) >= 5
        assert session.all("mavstack/uav1/telemetry/gps")[-1]["fix"] == "3D_FIX"
        states = session.all("mavstack/uav1/state")
        assert states[-1]["armed"] is False
        assert states[-1]["autopilot"] in ("ARDUPILOTMEGA", "PX4")
        await vehicle.arm()
        await asyncio.sleep(1.5)
        assert session.all("mavstack/uav1/state")[-1]["armed"] is True
        armed = session.all("mavstack/uav1/event/armed")
        assert [(event["previous"], event["value"]) for event in armed] == [(False, True)]
        retained = {topic for topic, _, _, retain, _ in session.published if retain}
        assert retained == {"mavstack/uav1/status", "mavstack/uav1/state"}
        topics.receive_status_text(4, "PreArm: test")
        assert session.all("mavstack/uav1/event/text")[-1]["text"] == "PreArm: test"
        topics.set_connected(connected=False)
        assert session.all("mavstack/uav1/status")[-1] == "offline"
        await topics.close()
        assert not session.is_open

    fly(kind, scenario)


def test_a_new_connection_gets_what_is_retained() -> None:
    async def scenario(world: World, vehicle: Vehicle) -> None:
        topics, session = await opened(vehicle)
        session.published.clear()
        session.connected()
        assert session.all("mavstack/uav1/status") == ["online"]
        assert len(session.all("mavstack/uav1/state")) == 1
        await topics.close()

    fly(COPTER, scenario)


def test_commands_fly_and_answer() -> None:
    async def scenario(world: World, vehicle: Vehicle) -> None:
        await vehicle.get_position()
        topics, session = await opened(vehicle, role=Role.OPERATE)
        assert session.subscriptions == ["mavstack/uav1/cmd/+"]
        session.arrive("mavstack/uav1/cmd/arm", b"{}", response_topic="client/1", correlation=b"\x01\x02")
        await world.wait_until(lambda: bool(session.all("client/1")))
        assert session.all("client/1") == [{"command": "arm", "ok": True}]
        assert [each[-1] for each in session.published if each[0] == "client/1"] == [b"\x01\x02"]
        session.arrive("mavstack/uav1/cmd/takeoff", b'{"altitude": 10}')
        await world.wait_until(lambda: bool(session.all("mavstack/uav1/result/takeoff")))
        assert session.all("mavstack/uav1/result/takeoff") == [{"command": "takeoff", "ok": True}]
        assert vehicle.position.relative_altitude == pytest.approx(10, abs=1)
        session.arrive("mavstack/uav1/cmd/param_set", b'{"name": "RTL_ALT", "value": 9}')
        await world.wait_until(lambda: bool(session.all("mavstack/uav1/result/param_set")))
        refused = session.all("mavstack/uav1/result/param_set")[0]
        assert refused["reason"] == (
            "param_set refused: it needs the role administer, the bridge has operate"
        )
        await topics.close()

    fly(COPTER, scenario)


def test_a_refusal_has_the_reason_of_the_vehicle() -> None:
    async def scenario(world: World, vehicle: Vehicle) -> None:
        topics, session = await opened(vehicle, role=Role.ADMINISTER)
        session.arrive("mavstack/uav1/cmd/arm")
        await world.wait_until(lambda: bool(session.all("mavstack/uav1/result/arm")))
        answer = session.all("mavstack/uav1/result/arm")[0]
        assert answer["ok"] is False
        assert answer["reason"].startswith("arming 1/1 failed: FAILED (")
        assert answer["code"] == 4
        assert topics.commands.refused == 1
        await topics.close()

    fly(COPTER, scenario, ready=False)


def test_an_observing_bridge_refuses_and_answers_reads() -> None:
    async def scenario(world: World, vehicle: Vehicle) -> None:
        topics, session = await opened(vehicle)
        session.arrive("mavstack/uav1/cmd/arm")
        session.arrive("mavstack/uav1/cmd/param_get", b'{"name": "RTL_ALT"}')
        await world.wait_until(lambda: bool(session.all("mavstack/uav1/result/param_get")))
        assert "--allow-control" in session.all("mavstack/uav1/result/arm")[0]["reason"]
        assert session.all("mavstack/uav1/result/param_get")[0]["result"]["value"] == 1500
        assert vehicle.armed is False
        await topics.close()

    fly(COPTER, scenario)


def test_home_assistant_gets_a_description_with_modes() -> None:
    async def scenario(world: World, vehicle: Vehicle) -> None:
        topics, session = await opened(vehicle, role=Role.OPERATE, discovery="homeassistant")
        place = "homeassistant/device/mavstack_uav1/config"
        await world.wait_until(lambda: len(session.all(place)) == 2)
        found = session.all(place)[-1]
        assert "GUIDED" in found["components"]["select_mode"]["options"]
        assert found["availability_topic"] == session.will
        await topics.close()

    fly(COPTER, scenario)
