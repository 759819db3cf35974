"""Observers of a station that try to make a vehicle work, or to delay a pilot: by counts, in virtual time."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

import pytest

from mavstack.dialects import common
from mavstack.security.observer_requests import LIST_INTERVAL, MAX_BURST
from mavstack.security.roles import Role
from mavstack.server.access import Access
from mavstack.server.client_shares import MAX_OBSERVED_STREAMS, MAX_STREAMS_PER_SESSION
from mavstack.server.json_values import to_json
from mavstack.vehicle import Connection
from mavstack.wire import Encoder
from tests.server.stations import COPTER, Ground, serve

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

PASSWORDS = {Role.OBSERVE: "watching only", Role.OPERATE: "may fly it"}
LIST = Encoder(200, 190).encode(common.ParamRequestList(target_system=1, target_component=1))
MISSION = "/api/vehicles/1/mission"
DISARM, STREAM = "/api/vehicles/1/disarm", "/api/vehicles/1/messages/ATTITUDE/stream"
#: The longest time in seconds from a request to the end of its disarm.
MAX_DELAY = 0.1


def run(scenario: Callable[[Ground], Awaitable[None]]) -> None:
    serve(COPTER, scenario, access=Access(passwords=PASSWORDS, local=False))


async def session(ground: Ground, role: Role = Role.OBSERVE) -> tuple[dict[str, str], str]:
    """Begin a session; return the headers of its requests, and a ticket."""
    begun = (await ground.api.post("/api/session", {"password": PASSWORDS[role]})).json
    return {"authorization": f"Bearer {begun['token']}"}, begun["ticket"]


async def disarm_delay(ground: Ground, headers: dict[str, str]) -> float:
    now = ground.station.connection.now
    began = now()
    assert (await ground.api.post(DISARM, {}, headers=headers)).status == 200
    return now() - began


def test_a_flood_of_requests_for_all_parameters_reaches_the_vehicle_once(monkeypatch) -> None:
    """Before: 955,000 were forwarded in 6 s, and the disarm timed out."""
    forwarded: list[bytes] = []
    monkeypatch.setattr(Connection, "forward", lambda _, packet: forwarded.append(packet.raw))

    async def scenario(ground: Ground) -> None:
        pilot, _ = await session(ground, Role.OPERATE)
        _, ticket = await session(ground)
        async with ground.api.websocket("ados-ws-ticket", ticket, "mavstack.raw.1") as socket:
            began = ground.station.connection.now()
            for _ in range(5):
                await socket.send(LIST * 20_000)
            assert max([await disarm_delay(ground, pilot) for _ in range(5)]) <= MAX_DELAY
            await asyncio.sleep(20)
        elapsed = ground.station.connection.now() - began
        assert 1 <= len(forwarded) <= 1 + elapsed / LIST_INTERVAL
        assert set(forwarded) == {LIST}

    run(scenario)


@pytest.mark.parametrize("subprotocol", ["mavstack.raw.1", "mavstack.json.1", "post"])
def test_different_requests_pass_at_a_limited_rate(monkeypatch, subprotocol) -> None:
    sent: list[object] = []
    monkeypatch.setattr(Connection, "forward", lambda _, packet: sent.append(packet))
    monkeypatch.setattr(Connection, "send", lambda _, message: sent.append(message))

    async def scenario(ground: Ground) -> None:
        sent.clear()
        headers, ticket = await session(ground)
        fields = [{"target_system": 1, "target_component": 1, "param_index": number} for number in range(100)]
        bodies = [{"message": "PARAM_REQUEST_READ", "fields": each} for each in fields]
        if subprotocol == "post":
            answers = [await ground.api.post("/api/messages", each, headers=headers) for each in bodies]
            assert {each.status for each in answers} == {200, 429}
            assert len(sent) <= MAX_BURST + 1
            return
        async with ground.api.websocket("ados-ws-ticket", ticket, subprotocol) as socket:
            for each, body in zip(fields, bodies, strict=True):
                raw = Encoder(200, 190).encode(common.ParamRequestRead(**each))
                await socket.send(raw if subprotocol == "mavstack.raw.1" else {"send": body})
            await asyncio.sleep(1)
        assert 1 <= len(sent) <= MAX_BURST + 8

    run(scenario)


def test_a_message_that_the_station_knows_is_answered_by_the_station(monkeypatch) -> None:
    forwarded: list[bytes] = []
    monkeypatch.setattr(Connection, "forward", lambda _, packet: forwarded.append(packet.raw))
    ask = common.CommandLong(
        target_system=1, target_component=1, command=common.MavCmd.REQUEST_MESSAGE, param1=0
    )

    async def scenario(ground: Ground) -> None:
        _, ticket = await session(ground)
        async with ground.api.websocket("ados-ws-ticket", ticket, "mavstack.raw.1") as socket:
            known = ground.station.packets.latest.find(1, 0)
            for _ in range(10):
                await socket.send(Encoder(200, 190).encode(ask))
            while await socket.receive() != known.packet.raw:
                known = ground.station.packets.latest.find(1, 0)
        assert len(forwarded) == 1

    run(scenario)


def test_streams_of_observers_leave_places_to_a_pilot() -> None:
    """Before: 530 streams of one observer made the disarm unanswerable."""

    async def scenario(ground: Ground) -> None:
        pilot, _ = await session(ground, Role.OPERATE)
        refused, open_streams = [], set()

        async def follow(headers: dict[str, str]) -> None:
            answer = await ground.api.get(STREAM, headers=headers)
            refused.append(answer.status)

        for _ in range(10):
            headers, _ = await session(ground)
            open_streams |= {asyncio.create_task(follow(headers)) for _ in range(53)}
        await asyncio.sleep(1)
        assert len(ground.station.shares) == MAX_OBSERVED_STREAMS
        assert set(refused) == {429}
        assert len(refused) == 530 - MAX_OBSERVED_STREAMS
        assert max([await disarm_delay(ground, pilot) for _ in range(5)]) <= MAX_DELAY
        following = [asyncio.create_task(ground.api.get(STREAM, headers=pilot)) for _ in range(4)]
        await asyncio.sleep(1)
        assert len(ground.station.shares) == MAX_OBSERVED_STREAMS + 4
        for task in (*open_streams, *following):
            task.cancel()
        await asyncio.gather(*open_streams, *following, return_exceptions=True)
        assert len(ground.station.shares) == 0

    run(scenario)


def test_websockets_of_one_session_have_a_share_and_end_with_it() -> None:
    async def scenario(ground: Ground) -> None:
        headers, _ = await session(ground)
        statuses = []
        for _ in range(MAX_STREAMS_PER_SESSION + 2):
            ticket = (await ground.api.get("/api/session", headers=headers)).json["ticket"]
            socket = ground.api.websocket("ados-ws-ticket", ticket, "mavstack.raw.1")
            try:
                await socket.__aenter__()
            except Exception as error:  # noqa: BLE001 (the status is what counts)
                statuses.append(str(error))
        assert statuses == ["429"] * 2
        await ground.api.delete("/api/session", headers=headers)
        await ground.wait_until(lambda: not len(ground.station.shares))
        assert not ground.station.packets.clients

    run(scenario)


def test_results_for_many_observers_are_written_one_in_a_turn(monkeypatch) -> None:
    """Before: all observers that waited for one plan got its JSON in one turn of the event loop."""
    written = 0

    def counted(answer: object) -> object:
        nonlocal written
        written += 1
        return to_json(answer)

    async def scenario(ground: Ground) -> None:
        headers, _ = await session(ground)
        monkeypatch.setattr("mavstack.server.dispatch.to_json", counted)
        reads = [asyncio.create_task(ground.api.get(MISSION, headers=headers)) for _ in range(40)]
        largest = 0
        while not all(read.done() for read in reads):
            before = written
            await asyncio.sleep(0)
            largest = max(largest, written - before)
        assert {read.result().status for read in reads} == {200}
        assert written == 40
        assert largest == 1

    run(scenario)
