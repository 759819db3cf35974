"""Random messages: no exceptions, no endless transfers, no unbounded growth."""

from __future__ import annotations

from random import Random

from hypothesis import given
from hypothesis import strategies as st

from mavstack.dialects import common
from mavstack.services.mission import MissionClient, MissionServer, PlanType
from tests.services.mission.scripted_peer import ScriptedPeer, plan_of
from tests.services.network import GROUND, VEHICLE

CLASSES = [
    common.MissionRequestList,
    common.MissionRequest,
    common.MissionRequestInt,
    common.MissionCount,
    common.MissionItem,
    common.MissionItemInt,
    common.MissionAck,
    common.MissionClearAll,
    common.MissionSetCurrent,
    common.MissionWritePartialList,
    common.MissionRequestPartialList,
    common.MissionCurrent,
    common.MissionItemReached,
]
MESSAGES = st.lists(
    st.tuples(st.sampled_from(CLASSES), st.binary(max_size=40), st.floats(0, 3), st.booleans()), max_size=30
)


def feed(peer: ScriptedPeer, messages) -> None:
    for kind, payload, pause, small in messages:
        message = kind.from_payload(payload[: len(kind().to_payload()) or 1])
        if small:  # of a type and a number that the other end knows
            for field in ("seq", "count"):
                if hasattr(message, field):
                    setattr(message, field, getattr(message, field) % 4)
            if hasattr(message, "mission_type"):
                message.mission_type = PlanType.MISSION
        received = peer.send(message)
        assert len(received) < 10
        received = peer.wait_for_all(pause)
        assert len(received) < 200


@given(MESSAGES)
def test_server_takes_anything(messages) -> None:
    server = MissionServer(VEHICLE)
    server.replace(plan_of(3))
    feed(ScriptedPeer(server, GROUND), messages)


@given(MESSAGES, st.integers(0, 3))
def test_client_takes_anything(messages, what) -> None:
    client = MissionClient(GROUND, VEHICLE)
    peer = ScriptedPeer(client, VEHICLE)
    operations = [
        client.upload(plan_of(3), peer.now),
        client.download(peer.now),
        client.clear(peer.now, PlanType.ALL),
        client.set_current(1, peer.now),
    ][what:]
    feed(peer, messages)
    peer.wait_for_all(600)
    assert all(operation.done for operation in operations)


def test_random_bytes_in_every_message_for_long() -> None:
    random = Random(1)
    server, client = MissionServer(VEHICLE), MissionClient(GROUND, VEHICLE)
    station, vehicle = ScriptedPeer(server, GROUND), ScriptedPeer(client, VEHICLE)
    upload = client.upload(plan_of(3), vehicle.now)
    for _ in range(3000):
        kind = random.choice(CLASSES)
        message = kind.from_payload(random.randbytes(len(kind().to_payload())))
        station.send(message)
        vehicle.send(message)
        station.wait_for_all(0.01)
        vehicle.wait_for_all(0.01)
    assert upload.done
