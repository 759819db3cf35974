"""The MAVLink version of a channel that follows its peer."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.node.channel_state import ChannelState
from mavstack.node.engine import Engine
from mavstack.security import SigningKey
from mavstack.services import Address, Priority
from mavstack.wire import Packet, encode
from tests.services.network import GROUND, START


def heard(version: int, message=None, *, component: int = 1) -> bytes:
    return encode(message or common.Heartbeat(), system=1, component=component, version=version)


def sent_version(channel: ChannelState) -> int:
    return Packet(channel.encode(common.Heartbeat(), GROUND, START, Priority.STREAM), common).version


@pytest.mark.parametrize("version", [1, 2])
def test_a_fixed_version_stays(version) -> None:
    channel = ChannelState("wire", common, version=version)
    for spoken in (1, 2):
        channel.receive(heard(spoken), START)
        assert sent_version(channel) == version


def test_auto_speaks_version_1_until_the_peer_speaks_version_2() -> None:
    channel = ChannelState("wire", common, version="auto")
    assert sent_version(channel) == 2
    channel.receive(heard(1), START)
    assert sent_version(channel) == 1
    channel.receive(heard(2), START)
    channel.receive(heard(1), START)
    assert sent_version(channel) == 2


def test_auto_follows_the_capability_of_the_peer() -> None:
    channel = ChannelState("wire", common, version="auto")
    channel.receive(heard(1, common.AutopilotVersion()), START)
    assert sent_version(channel) == 1
    able = common.AutopilotVersion(capabilities=common.MavProtocolCapability.MAVLINK2)
    channel.receive(heard(1, able), START)
    assert sent_version(channel) == 2


def test_auto_ignores_a_radio_on_the_way() -> None:
    channel = ChannelState("wire", common, version="auto")
    channel.receive(heard(1, common.RadioStatus(), component=68), START)
    assert sent_version(channel) == 2


def test_sequence_numbers_go_on_when_the_version_changes() -> None:
    channel = ChannelState("wire", common, version="auto")
    numbers = []
    for spoken in (1, 2):
        data = channel.encode(common.Heartbeat(), GROUND, START, Priority.STREAM)
        numbers.append(Packet(data, common).sequence)
        channel.receive(heard(spoken), START)
    data = channel.encode(common.Heartbeat(), GROUND, START, Priority.STREAM)
    assert [*numbers, Packet(data, common).sequence] == [0, 1, 2]


def test_a_signed_channel_speaks_version_2() -> None:
    key = SigningKey.generate()
    channel = ChannelState("wire", common, version="auto")
    channel.receive(heard(1), START)
    channel.signing = key.signing()
    assert sent_version(channel) == 2
    channel.signing = None
    assert sent_version(channel) == 1


def test_the_version_is_that_of_each_channel() -> None:
    engine = Engine(GROUND)
    old, new = (engine.open_channel(name, version="auto") for name in ("old", "new"))
    engine.receive(old, heard(1), START)
    engine.receive(new, encode(common.Heartbeat(), system=2, component=1), START)
    engine.send(common.Heartbeat(), START)
    versions = {channel.name: Packet(data, common).version for channel, data in engine.data_to_send(START)}
    assert versions == {"old": 1, "new": 2}
    assert engine.routes.heard_on(Address(1, 1)) == (old,)
