"""The mission server and the ground station of its tests."""

from __future__ import annotations

from mavstack.dialects import common
from mavstack.services import Address
from mavstack.services.mission import (
    MissionServer,
)
from tests.services.mission.scripted_peer import ScriptedStation
from tests.services.network import VEHICLE

OTHER = Address(254, 190)


def make_server(*, store=None, options=None, **callbacks) -> ScriptedStation:
    return ScriptedStation(MissionServer(VEHICLE, store, options, **callbacks))


def result_of(messages: list) -> int:
    (ack,) = [message for message in messages if isinstance(message, common.MissionAck)]
    return ack.type
