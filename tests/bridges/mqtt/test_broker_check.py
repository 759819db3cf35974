"""Findings about vehicles on a broker: from its messages, and with mosquitto and a bridge."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

import pytest

from mavstack.bridges.mqtt.bridge import MqttBridge
from mavstack.bridges.mqtt.broker import Broker
from mavstack.bridges.mqtt.broker_check import check_broker, describe
from mavstack.bridges.mqtt.vehicle_topics import MqttOptions
from mavstack.security.roles import Role
from mavstack.sim.background import BackgroundSimulator
from mavstack.vehicle import connect
from tests.bridges.mqtt.test_broker import Client, broker, needs_mosquitto
from tests.bridges.ros2.running import until

if TYPE_CHECKING:
    from pathlib import Path

STATE = b'{"autopilot": "PX4", "type": "quadrotor", "mode": "HOLD", "role": "%s"}'


def texts(**kept: bytes) -> list[tuple[bool, str]]:
    topics = {f"fleet/{key.replace('__', '/')}": payload for key, payload in kept.items()}
    return [(each.ok, each.text) for each in describe("mqtt://b:1883", "fleet", topics)][1:]


def test_a_broker_without_vehicles() -> None:
    ((ok, text),) = texts()
    assert not ok
    assert text.startswith("no vehicle is below fleet/: does `mav bridge mqtt` run")


@pytest.mark.parametrize(("count", "others"), [(b"1", "0 clients"), (b"2", "1 client"), (b"4", "3 clients")])
def test_the_number_of_clients(count: bytes, others: str) -> None:
    (first, _) = describe("mqtt://b:1883", "x", {"$SYS/broker/clients/connected": count})
    assert first.text == f"the broker mqtt://b:1883 has {others}, with one for each vehicle of a bridge"


def test_a_number_of_clients_that_is_not_one() -> None:
    (first, _) = describe("mqtt://b:1883", "x", {"$SYS/broker/clients/connected": b"\xff"})
    assert first.text == "the broker mqtt://b:1883 accepts clients, and does not report their number"
    (first, _) = describe("mqtt://b:1883", "x", {"$SYS/broker/clients/connected": b"9" * 5000})
    assert first.text.endswith("does not report their number")


def test_a_topic_without_a_vehicle_is_none() -> None:
    ((ok, text),) = texts(status=b"online")
    assert not ok
    assert text.startswith("no vehicle is below fleet/")


def test_an_offline_vehicle_is_a_problem() -> None:
    assert texts(uav1__status=b"offline") == [
        (False, "uav1 is offline: its bridge has ended, or receives no heartbeats of it")
    ]


@pytest.mark.parametrize(
    ("state", "text"),
    [
        (STATE % b"operate", "uav1 answers requests, with the role operate"),
        (STATE % b"observe", "uav1 answers requests and refuses commands: its bridge has no --allow-control"),
        (b"[1", "uav1 answers requests and refuses commands: its bridge has no --allow-control"),
    ],
    ids=["operate", "observe", "not JSON"],
)
def test_a_vehicle_that_answers(state: bytes, text: str) -> None:
    found = texts(uav1__status=b"online", uav1__state=state, uav1__result__check=b"{}")
    assert found[1] == (True, text)


def test_a_vehicle_that_does_not_answer_is_a_problem() -> None:
    found = texts(uav1__status=b"online", uav1__state=STATE % b"operate")
    assert found[0] == (True, "uav1 is online (PX4, quadrotor, HOLD)")
    assert found[1][0] is False
    assert found[1][1].startswith("uav1 does not answer requests: may this client publish on fleet/uav1/cmd/")


@pytest.mark.interop
@needs_mosquitto
def test_a_bridge_with_mosquitto(tmp_path: Path) -> None:
    pytest.importorskip("paho.mqtt")

    async def scenario(url: str, port: int) -> None:
        place = Broker("127.0.0.1", port)
        async with (
            connect(url) as connection,
            MqttBridge(connection, MqttOptions(place, "fleet", role=Role.OPERATE)) as bridge,
        ):
            await connection.wait_for_vehicle()
            await until(lambda: 1 in bridge.vehicles and bridge.vehicles[1].session._online)
            found = await check_broker(place, "fleet")
            assert all(each.ok for each in found), found
            assert found[1].text.startswith("uav1 is online (ARDUPILOTMEGA, copter")
            assert found[-1].text == "uav1 answers requests, with the role operate"
            vehicle = bridge.vehicles[1]
            assert vehicle.commands.refused == 1
        found = await check_broker(place, "fleet")
        assert [each.ok for each in found] == [True, False]

    with BackgroundSimulator() as simulator, broker(tmp_path) as port:
        Client(port).close()  # waits until the broker listens
        asyncio.run(scenario(simulator.url, port))
