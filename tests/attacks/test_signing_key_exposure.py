"""A signing key that a station sends never leaves the node: neither in text, nor by forwarding."""

from __future__ import annotations

import asyncio
import json

import pytest

from mavstack.dialects import Dialect, common, minimal
from mavstack.errors import FieldTypeError
from mavstack.links import BytesReceived, open_link
from mavstack.node import Node
from mavstack.node.forwarding import Forwarding
from mavstack.wire import Encoder

KEY = bytes(range(100, 132))
SETUP = common.SetupSigning(target_system=1, target_component=1, secret_key=KEY, initial_timestamp=987_654)
ALL = Dialect.load("all")
SECRETS = [
    SETUP,
    common.AuthKey(key="hunter2secret"),
    common.ChangeOperatorControl(passkey="hunter2secret"),
    common.WifiConfigAp(ssid="drone", password="hunter2secret"),
    common.CellularConfig(pin="hunter2secret", new_pin="hunter2secret", puk="hunter2secret"),
    ALL["AIRLINK_AUTH"](login="me", password="hunter2secret"),
]


def shows_secret(text: str) -> bool:
    return any(trace in text for trace in ("hunter2secret", "100, 101", "987654", "defg", KEY.hex()))


@pytest.mark.parametrize("message", SECRETS, ids=lambda message: type(message).__name__)
def test_no_text_of_a_message_shows_its_secrets(message):
    for text in (
        repr(message),
        str(message),
        f"{message}",
        message.to_json(),
        message.to_json(enums="name"),
        str(message.to_dict()),
        str(message.to_dict(enums="value")),
    ):
        assert not shows_secret(text)
    assert shows_secret(message.to_json(secrets=True))
    assert type(message).from_json(message.to_json(secrets=True)) == message


@pytest.mark.parametrize("message", SECRETS, ids=lambda message: type(message).__name__)
def test_a_hidden_secret_is_not_read_back_as_a_value(message):
    with pytest.raises(FieldTypeError, match="hidden"):
        type(message).from_json(message.to_json())
    with pytest.raises(FieldTypeError, match="hidden"):
        type(message).from_dict(message.to_dict())
    assert json.loads(message.to_json())


class Peer:
    """A program at the other end of a UDP link that collects the received bytes."""

    def __init__(self, url: str) -> None:
        self.link = open_link(url)
        self.data = b""

    async def __aenter__(self):
        await self.link.open()
        self.task = asyncio.create_task(self._collect())
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.link.close()
        await self.task

    async def _collect(self) -> None:
        async for event in self.link:
            if isinstance(event, BytesReceived):
                self.data += event.data

    def write(self, data: bytes) -> None:
        for channel in self.link.channels:
            channel.write(data)

    @property
    def url(self) -> str:
        host, port = self.link.address
        return f"udpout://{host}:{port}"


# `minimal` does not define the message, which is recognised by its id.
@pytest.mark.parametrize("dialect", [common, minimal], ids=["common", "minimal"])
async def test_a_key_is_not_forwarded_in_either_direction(dialect):
    async with (
        Peer("udpin://127.0.0.1:0?trust_senders=yes") as vehicle,
        Peer("udpin://127.0.0.1:0?trust_senders=yes") as station,
        Node(vehicle.url, dialect=dialect) as node,
        Forwarding(node) as forwarding,
    ):
        await forwarding.add(station.url)
        station_encoder, vehicle_encoder = Encoder(255, 200), Encoder(1, 1)
        await asyncio.sleep(0.1)
        for _ in range(3):
            # The peer of the output learns the address of the node from the first forwarded packet.
            vehicle.write(vehicle_encoder.encode(common.Heartbeat(type=common.MavType.QUADROTOR)))
            await asyncio.sleep(0.05)
        vehicle.write(vehicle_encoder.encode(SETUP.replace(target_system=255, target_component=200)))
        vehicle.write(vehicle_encoder.encode(SETUP.replace(target_system=0, target_component=0)))
        vehicle.write(last_of_vehicle := vehicle_encoder.encode(common.Heartbeat(custom_mode=77)))
        station.write(station_encoder.encode(SETUP))
        station.write(station_encoder.encode(SETUP.replace(target_system=0, target_component=0)))
        station.write(last_of_station := station_encoder.encode(common.Heartbeat(custom_mode=78)))
        await asyncio.sleep(0.2)
        assert last_of_vehicle in station.data
        assert last_of_station in vehicle.data
        assert KEY not in station.data
        assert KEY not in vehicle.data
