from __future__ import annotations

from time import time

import pytest

from mavstack.errors import LinkError
from mavstack.links import ChannelOpened, open_link
from mavstack.links.channel import Request
from mavstack.links.options import Options
from mavstack.links.url import parse_url
from mavstack.links.ws_gate import WsGate
from mavstack.security.roles import Role
from mavstack.security.tickets import SUBPROTOCOL, make_ticket

from .certificates import certificates  # noqa: F401 - a fixture

pytest.importorskip("websockets")

from websockets.asyncio.client import connect
from websockets.exceptions import InvalidStatus

KEY = "ados_secret"
NOW = 1_000_000


@pytest.fixture
def key_file(tmp_path):
    path = tmp_path / "gate.txt"
    path.write_text(KEY + "\n")
    return path


@pytest.fixture
def gate(key_file):
    url = parse_url(f"wsin://0.0.0.0:5770?ticket_key={key_file}")
    return WsGate(url, Options(url))


def ticket(number: int = 0, now: float = NOW, **changes) -> str:
    return make_ticket(KEY, now=now, nonce=number.to_bytes(16), **changes)


def check(gate: WsGate, offered: str, now: float = NOW, headers=None):
    decision = gate.check(Request("/", {}, headers or {}), offered, now)
    return None if isinstance(decision, Role) else (int(decision.status), decision.reason)


def test_a_ticket_opens_the_gate_once(gate):
    offered = f"{SUBPROTOCOL}, {ticket()}"
    assert check(gate, offered) is None
    assert check(gate, offered) == (401, "the ticket has been used")
    assert gate.refusals == {"the ticket has been used": 1}


@pytest.mark.parametrize(
    ("offered", "status", "reason"),
    [
        ("", 401, "a ticket is needed"),
        (SUBPROTOCOL, 401, "a ticket is needed"),
        (ticket(), 401, "a ticket is needed"),
        (f"{ticket()},{SUBPROTOCOL}", 401, "a ticket is needed"),
        (f"{SUBPROTOCOL},x,{ticket()}", 401, "malformed"),
        (f"{SUBPROTOCOL},{ticket().upper()}", 401, "malformed"),
        (f"{SUBPROTOCOL},{ticket()}\x00", 401, "malformed"),
        (f"{SUBPROTOCOL},{make_ticket('other', now=NOW, nonce=bytes(16))}", 401, "signature"),
        (f"{SUBPROTOCOL},{ticket(now=NOW - 30)}", 401, "expired"),
        (f"{SUBPROTOCOL},{ticket(now=NOW + 60)}", 401, "future"),
        (f"{SUBPROTOCOL},{ticket(scope='gs.video')}", 403, "another scope"),
    ],
)
def test_refusals(gate, offered, status, reason):
    code, text = check(gate, offered)
    assert code == status
    assert reason in text
    assert sum(gate.refusals.values()) == 1


@pytest.mark.parametrize(
    ("suffix", "role"),
    [
        ("", Role.ADMINISTER),
        (".observe", Role.OBSERVE),
        (".operate", Role.OPERATE),
        (".administer", Role.ADMINISTER),
    ],
)
def test_the_scope_of_a_ticket_is_its_role(gate, suffix, role):
    made = ticket(scope=f"gs.mavlink_ws{suffix}")
    assert gate.check(Request("/", {}, {}), f"{SUBPROTOCOL},{made}", NOW) is role


def test_a_token_is_enough_beside_tickets(key_file):
    url = parse_url(f"wsin://0.0.0.0:5770?ticket_key={key_file}&token=right")
    gate = WsGate(url, Options(url))
    assert check(gate, "", headers={"authorization": "Bearer right"}) is None
    assert check(gate, f"{SUBPROTOCOL},{ticket()}") is None
    assert check(gate, "", headers={"authorization": "Bearer wrong"})[0] == 401


def test_the_program_decides_behind_the_ticket(gate):
    gate.accept = lambda request: "no room"
    assert check(gate, "")[0] == 401
    assert check(gate, f"{SUBPROTOCOL},{ticket()}") == (403, "no room")
    assert gate.refusals["refused by the program"] == 1


async def test_client_and_server(key_file):
    async with open_link(f"wsin://127.0.0.1:0?ticket_key={key_file}&subprotocol=mavlink") as server:
        url = f"ws://127.0.0.1:{server.address[1]}"
        for _ in range(2):  # each attempt to connect has a ticket of its own
            async with open_link(f"{url}?ticket_key={key_file}&subprotocol=mavlink"):
                event = await anext(server)
                while not isinstance(event, ChannelOpened):
                    event = await anext(server)
                assert event.channel.request.subprotocol == SUBPROTOCOL
        with pytest.raises(LinkError, match="401"):
            await open_link(url)
        assert server.gate.refusals == {"a ticket is needed": 1}


async def test_a_browser_gets_its_subprotocol_back_and_no_replay(key_file):
    async with open_link(f"wsin://127.0.0.1:0?ticket_key={key_file}&origin=*") as server:
        url = f"ws://127.0.0.1:{server.address[1]}"
        offered = [SUBPROTOCOL, make_ticket(KEY, now=time(), nonce=bytes(16))]
        socket = await connect(url, subprotocols=offered, origin="https://ground.example", proxy=None)
        assert socket.subprotocol == SUBPROTOCOL
        await socket.close()
        with pytest.raises(InvalidStatus, match="401"):
            await connect(url, subprotocols=offered, proxy=None)


@pytest.mark.parametrize("scheme", ["ws", "wsin"])
def test_a_missing_key_is_named_but_never_shown(tmp_path, scheme):
    with pytest.raises(LinkError, match="cannot read the API key") as error:
        open_link(f"{scheme}://127.0.0.1:5770?ticket_key={tmp_path}/no.key")
    assert "ticket_key=***" in str(error.value)


async def test_a_ticket_opens_a_gate_over_tls(key_file, certificates):  # noqa: F811
    files = f"cert={certificates}/cert.pem&key={certificates}/key.pem"
    async with open_link(f"wssin://127.0.0.1:0?{files}&ticket_key={key_file}") as server:
        url = f"wss://127.0.0.1:{server.address[1]}?ca={certificates}/ca.pem&ticket_key={key_file}"
        async with open_link(url):
            assert isinstance(await anext(server), ChannelOpened)
