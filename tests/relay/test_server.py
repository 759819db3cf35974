from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from websockets.asyncio.client import connect
from websockets.exceptions import ConnectionClosed, InvalidStatus

from mavstack.errors import LinkError
from mavstack.links.relay_frames import RELAY_PROTOCOL, Change, encode_datagram, encode_notice
from mavstack.relay.revocations import revoke
from mavstack.relay.rooms import Limits
from mavstack.relay.server import RelayServer
from mavstack.security.room_tickets import Seat
from tests.links.certificates import certificates

from .harness import API_KEY, relay, ticket

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["certificates"]


def dial(port: int, *words: str, scheme: str = "ws", **options):
    return connect(
        f"{scheme}://127.0.0.1:{port}", subprotocols=list(words), proxy=None, close_timeout=0.1, **options
    )


async def test_a_host_and_a_guest_meet():
    async with relay() as (server, port):
        async with (
            dial(port, RELAY_PROTOCOL, ticket(Seat.HOST)) as host,
            dial(port, RELAY_PROTOCOL, ticket(Seat.GUEST)) as guest,
        ):
            assert guest.subprotocol == RELAY_PROTOCOL
            assert await host.recv() == encode_notice(Change.CAME, 1)
            await guest.send("text is dropped")
            await guest.send(b"up")
            assert await host.recv() == encode_datagram(1, b"up")
            await host.send(encode_datagram(1, b"down"))
            assert await guest.recv() == b"down"
            await guest.close()
            assert await host.recv() == encode_notice(Change.LEFT, 1)
        assert server.rooms.counts["dropped"] == 1


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        ([], "a ticket is needed"),
        ([RELAY_PROTOCOL], "a ticket is needed"),
        ([RELAY_PROTOCOL, "room1.boat.host"], "the ticket is malformed"),
        ([RELAY_PROTOCOL, ticket(Seat.HOST, api_key="guessed")], "the signature of the ticket is wrong"),
        ([RELAY_PROTOCOL, ticket(Seat.HOST, lifetime=-1)], "the ticket has expired"),
    ],
)
async def test_clients_without_a_ticket_are_refused_before_the_websocket_opens(words, reason):
    async with relay() as (server, port):
        with pytest.raises(InvalidStatus, match="401"):
            async with dial(port, *words):
                pass
        assert server.rooms.counts == {f"refused: {reason}": 1}
        assert server.rooms.members == 0


async def test_a_member_without_a_place_is_sent_away_with_the_reason():
    async with (
        relay(Limits(guests=1)) as (_, port),
        dial(port, RELAY_PROTOCOL, ticket(Seat.GUEST)),
        dial(port, RELAY_PROTOCOL, ticket(Seat.GUEST)) as other,
    ):
        with pytest.raises(ConnectionClosed, match="the room is full"):
            await other.recv()


async def test_a_host_that_comes_back_replaces_its_older_connection():
    async with (
        relay() as (_, port),
        dial(port, RELAY_PROTOCOL, ticket(Seat.HOST)) as old,
        dial(port, RELAY_PROTOCOL, ticket(Seat.HOST)),
    ):
        with pytest.raises(ConnectionClosed, match="replaced by a newer connection"):
            await old.recv()


async def test_a_member_leaves_when_its_ticket_expires():
    async with relay() as (server, port):
        async with dial(port, RELAY_PROTOCOL, ticket(Seat.GUEST, lifetime=1.5)) as guest:
            with pytest.raises(ConnectionClosed, match="the ticket has expired"):
                await guest.recv()
        assert server.rooms.members == 0


async def test_tls(certificates):
    import ssl

    context = ssl.create_default_context(cafile=f"{certificates}/ca.pem")
    files = {"certificate": f"{certificates}/cert.pem", "certificate_key": f"{certificates}/key.pem"}
    async with (
        relay(**files) as (_, port),
        dial(port, RELAY_PROTOCOL, ticket(Seat.HOST), scheme="wss", ssl=context),
    ):
        pass


def test_a_certificate_that_cannot_be_used_is_named(tmp_path):
    with pytest.raises(LinkError, match=r"using the certificate .*none\.pem failed"):
        RelayServer(API_KEY, certificate=str(tmp_path / "none.pem"))


async def test_a_port_in_use_is_named():
    async with relay() as (_, port):
        with pytest.raises(LinkError, match=f"listening on 127.0.0.1:{port} failed"):
            async with RelayServer(API_KEY).serving("127.0.0.1", port):
                pass


async def test_a_ticket_that_is_revoked_during_the_handshake_ends(monkeypatch: pytest.MonkeyPatch):
    answers = iter([False, True])
    monkeypatch.setattr("mavstack.relay.server.Revocations.has", lambda _self, _ticket: next(answers))
    async with relay() as (_, port), dial(port, RELAY_PROTOCOL, ticket(Seat.HOST)) as ended:
        with pytest.raises(ConnectionClosed, match="the ticket is revoked"):
            await ended.recv()


async def test_one_revoked_ticket_ends_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("mavstack.relay.server.READ_INTERVAL", 0.01)
    path, one, other = tmp_path / "revoked.txt", ticket(Seat.GUEST), ticket(Seat.GUEST, lifetime=90)
    async with relay(revoked=path) as (server, port):
        async with dial(port, RELAY_PROTOCOL, one) as ended, dial(port, RELAY_PROTOCOL, other) as kept:
            revoke(one, path)
            with pytest.raises(ConnectionClosed, match="the ticket is revoked"):
                await ended.recv()
            await (await kept.ping())
        with pytest.raises(InvalidStatus, match="401"):
            async with dial(port, RELAY_PROTOCOL, one):
                pass
        assert server.rooms.counts["refused: the ticket is revoked"] == 1
        async with dial(port, RELAY_PROTOCOL, other):
            pass
