"""WebSockets and streams end with the session that opened them."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import pytest

from mavstack.dialects import common
from mavstack.security.roles import Role
from mavstack.server import access as access_module
from mavstack.server.access import SESSION_LIFETIME, Access
from mavstack.server.session_end import ending_with_session
from mavstack.sim.virtual import run_virtually
from mavstack.wire import Encoder
from tests.server.asgi import RefusedSocketError, SocketClient
from tests.server.stations import COPTER, Ground, serve

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

PASSWORDS = {Role.OBSERVE: "watching only", Role.OPERATE: "may fly it"}
PROTOCOLS = ("mavstack.raw.1", "mavstack.json.1", "mavstack.rows.1")
PING = Encoder(245, 191).encode(common.Ping())


def access() -> Access:
    return Access(passwords=PASSWORDS, local=False, now=lambda: asyncio.get_running_loop().time())


def scenario(steps: Callable[[Ground], Awaitable[None]]) -> None:
    """Run steps with a station that has passwords, whose sessions end in virtual time."""
    serve(COPTER, steps, access=access())


async def log_in(ground: Ground, role: Role = Role.OPERATE) -> dict[str, Any]:
    answer = await ground.api.post("/api/session", {"password": PASSWORDS[role]})
    ground.api.headers = {"authorization": f"Bearer {answer.json['token']}"}
    found: dict[str, Any] = answer.json
    return found


async def close_code(socket: SocketClient) -> int:
    """Read up to the end of a WebSocket."""
    async with asyncio.timeout(5):
        while True:
            message = await socket._to_client.get()
            if message["type"] == "websocket.close":
                return int(message["code"])


@pytest.mark.parametrize("protocol", PROTOCOLS)
@pytest.mark.parametrize("with_ticket", [True, False])
def test_a_log_out_closes_the_websockets_of_the_session_alone(protocol: str, with_ticket: bool) -> None:
    async def steps(ground: Ground) -> None:
        pilot = await log_in(ground)
        other = (await ground.api.post("/api/session", {"password": PASSWORDS[Role.OPERATE]})).json
        offered = ("ados-ws-ticket", pilot["ticket"], protocol) if with_ticket else (protocol,)
        async with (
            ground.api.websocket(*offered) as socket,
            ground.api.websocket("ados-ws-ticket", other["ticket"], "mavstack.raw.1") as staying,
        ):
            await ground.api.delete("/api/session")
            assert await close_code(socket) == 1008
            staying.clear()
            assert await staying.receive()
        assert ground.station.packets.clients == set()

    scenario(steps)


def test_a_log_out_closes_a_websocket_whose_client_does_not_read() -> None:
    async def steps(ground: Ground) -> None:
        await log_in(ground)
        async with ground.api.websocket("mavstack.raw.1") as socket:
            socket.pause()
            await asyncio.sleep(1)
            await ground.api.delete("/api/session")
            await ground.wait_until(lambda: not ground.station.packets.clients, timeout=2)

    scenario(steps)


@pytest.mark.parametrize("path", ["/api/vehicles/1/messages/HEARTBEAT/stream", "/api/tasks/1/progress"])
def test_a_log_out_ends_streams_of_events(path: str) -> None:
    async def steps(ground: Ground) -> None:
        await log_in(ground)
        assert (await ground.api.post("/api/vehicles/1/arm")).status == 200
        started = await ground.api.post("/api/vehicles/1/takeoff?wait=false", {"altitude": 1000})
        assert started.status == 202
        stream = asyncio.create_task(ground.api.get(path))
        await asyncio.sleep(2)
        assert not stream.done()
        await ground.api.delete("/api/session")
        async with asyncio.timeout(1):
            assert b"data: " in (await stream).data
        assert ground.station.packets.clients == set()

    scenario(steps)


def test_what_an_unused_session_opened_ends_with_it() -> None:
    async def steps(ground: Ground) -> None:
        await log_in(ground)
        now = asyncio.get_running_loop().time
        begun = now()
        async with ground.api.websocket("mavstack.raw.1") as socket:
            await asyncio.sleep(SESSION_LIFETIME / 2)
            socket.clear()
            await socket.send(PING)  # the session is used
            await asyncio.sleep(SESSION_LIFETIME * 0.75)
            socket.clear()
            assert await socket.receive()
            socket.pause()
            assert ground.station.packets.clients
            await ground.wait_until(lambda: not ground.station.packets.clients, timeout=SESSION_LIFETIME)
            assert now() - begun == pytest.approx(SESSION_LIFETIME * 1.5, abs=2)

    monkey = pytest.MonkeyPatch()
    with monkey.context() as patch:
        patch.setattr(access_module, "SESSION_LIFETIME", 40.0)
        patch.setitem(globals(), "SESSION_LIFETIME", 40.0)
        scenario(steps)


def test_a_session_that_makes_room_for_another_closes_its_websockets(monkeypatch: Any) -> None:
    monkeypatch.setattr(access_module, "MAX_SESSIONS", 1)

    async def steps(ground: Ground) -> None:
        await log_in(ground)
        async with ground.api.websocket("mavstack.raw.1") as socket:
            await log_in(ground)
            assert await close_code(socket) == 1008

    scenario(steps)


def test_a_ticket_of_an_ended_session_opens_nothing() -> None:
    async def steps(ground: Ground) -> None:
        ticket = (await log_in(ground))["ticket"]
        await ground.api.delete("/api/session")
        ground.api.headers = {}
        with pytest.raises(RefusedSocketError, match="401"):
            async with ground.api.websocket("ados-ws-ticket", ticket, "mavstack.raw.1"):
                pass

    scenario(steps)


def test_a_page_that_shows_its_session_keeps_its_cookie() -> None:
    async def steps(ground: Ground) -> None:
        begun = await ground.api.post("/api/session", {"password": PASSWORDS[Role.OPERATE]})
        cookie = begun.headers["set-cookie"]
        shown = await ground.api.get("/api/session", headers={"cookie": cookie.partition(";")[0]})
        assert shown.headers["set-cookie"] == cookie
        token = {"authorization": f"Bearer {begun.json['token']}"}
        assert "set-cookie" not in (await ground.api.get("/api/session", headers=token)).headers

    scenario(steps)


def test_the_own_timeout_of_a_block_is_not_taken_for_the_end_of_a_session() -> None:
    async def run() -> None:
        gate = access()
        token = gate.log_in("10.0.0.1", password="may fly it").session
        with pytest.raises(TimeoutError):
            async with ending_with_session(gate, token), asyncio.timeout(1):
                await asyncio.Event().wait()
        passed = []
        with suppress(TimeoutError):
            async with ending_with_session(gate, "no session"):
                await asyncio.Event().wait()
            passed.append("left at once")
        assert passed

    run_virtually(run())
