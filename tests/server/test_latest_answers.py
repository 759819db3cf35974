"""The early answer of a latest message is that of its route."""

from __future__ import annotations

import asyncio
import json

import pytest

from mavstack.http.early_answers import EarlyRequest
from mavstack.security.roles import Role
from mavstack.server.access import Access
from mavstack.server.app import make_early_answers
from mavstack.server.station import Station
from tests.server.stations import COPTER, Ground, serve

HOST = {"host": "127.0.0.1:8080"}
PATH = "/api/vehicles/1/messages/HEARTBEAT"


def test_the_early_answer_is_that_of_the_route() -> None:
    async def scenario(ground: Ground) -> None:
        latest = ground.station.packets.latest
        await ground.wait_until(lambda: latest.find(1, 0) is not None)
        answer = make_early_answers(ground.station, Access())
        for name in ("HEARTBEAT", "heartbeat"):
            path = f"/api/vehicles/1/messages/{name}"
            early = answer(EarlyRequest(path, HOST))
            usual = await ground.api.get(path)
            head, _, body = early.partition(b"\r\n\r\n")
            fields = dict(each.split(": ", 1) for each in head.decode().split("\r\n")[1:])
            assert fields.pop("date")
            assert (fields, body) == (usual.headers, usual.data)
        for path in (
            "/api/vehicles/1/messages/CAMERA_SETTINGS",
            "/api/vehicles/1/messages/NO_SUCH",
            "/api/vehicles/9/messages/HEARTBEAT",
            f"{PATH}?component=1",
            "/api/vehicles",
        ):
            assert answer(EarlyRequest(path, HOST)) is None

    serve(COPTER, scenario)


@pytest.mark.parametrize(
    "headers", [{"host": "evil.example"}, {**HOST, "sec-fetch-site": "cross-site"}, {"host": ""}]
)
def test_pages_of_other_sites_get_no_early_answer(headers) -> None:
    async def scenario(ground: Ground) -> None:
        await ground.wait_until(lambda: ground.station.packets.latest.find(1, 0) is not None)
        assert make_early_answers(ground.station, Access())(EarlyRequest(PATH, headers)) is None

    serve(COPTER, scenario)


def test_sessions_that_may_act_get_early_answers_observers_do_not() -> None:
    passwords = {Role.OBSERVE: "watching only", Role.OPERATE: "may fly it"}

    async def scenario(ground: Ground) -> None:
        await ground.wait_until(lambda: ground.station.packets.latest.find(1, 0) is not None)
        access = Access(passwords=passwords)
        answer = make_early_answers(ground.station, access)
        found = []
        for password in passwords.values():
            session = access.log_in("127.0.0.1", password=password).session
            found += [{"authorization": f"Bearer {session}"}, {"cookie": f"mavstack_session={session}"}]
        answers = [answer(EarlyRequest(PATH, {**HOST, **each})) for each in ({}, *found)]
        assert [each is not None for each in answers] == [False, False, False, True, True]
        body = answers[-1].partition(b"\r\n\r\n")[2]
        assert json.loads(body)["message"] == "HEARTBEAT"
        access.log_out(session)
        assert answer(EarlyRequest(PATH, {**HOST, **found[-1]})) is None

    serve(COPTER, scenario)


async def test_a_station_without_vehicles_has_no_early_answers() -> None:
    async with asyncio.timeout(20), Station() as station:
        assert make_early_answers(station, Access())(EarlyRequest(PATH, HOST)) is None
