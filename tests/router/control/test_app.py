from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager
from typing import Any, cast

import pytest
from starlette.requests import Request

from mavstack.errors import LinkError
from mavstack.http.bodies import MAX_BODY, RefusedError
from mavstack.http.server import serving
from mavstack.links.scheme_table import builtin_schemes
from mavstack.router.config import EndpointConfig
from mavstack.router.control.app import ControlApi
from mavstack.router.control.client import ControlClient
from mavstack.security.admission import Proof
from tests.router.peers import UdpPeer, heartbeat, port, routing, until

URL = "udpin://127.0.0.1:0"
GROUND = EndpointConfig("ground", URL)
JSON = "application/json"


@asynccontextmanager
async def controlled(**options):
    """A router with an endpoint, and a client that runs in a thread."""
    async with routing(GROUND) as router:
        api = ControlApi(router, **options)
        async with serving(api.app, "127.0.0.1:0", name="the control API") as (host, number):
            yield router, f"{host}:{number}"


async def ask(work, *arguments, **options):
    return await asyncio.to_thread(work, *arguments, **options)


async def test_endpoints_are_listed_added_changed_and_removed():
    async with controlled() as (router, address):
        client = ControlClient(address)
        await ask(client.add, "tablet", {"url": URL, "rate": "20 kB/s"})
        assert router.config.endpoint("tablet").rate == 20_000
        await ask(client.change, "tablet", {"listen_only": True, "out": {"deny_messages": ["ATTITUDE"]}})
        found = router.config.endpoint("tablet")
        assert (found.rate, found.listen_only, found.outgoing.deny_messages) == (20_000, True, {30})
        await ask(client.pause, "tablet")
        assert router.config.endpoint("tablet").pause
        await ask(client.pause, "tablet", paused=False)
        listed = await ask(client.endpoints)
        assert [(each["name"], each["state"], each["pause"]) for each in listed] == [
            ("ground", "open", False),
            ("tablet", "open", False),
        ]
        await ask(client.remove, "tablet")
        assert router.config.endpoint("tablet") is None


async def test_routes_and_counters():
    async with controlled() as (router, address):
        with UdpPeer(port(router, "ground")) as peer:
            peer.send(heartbeat(7))
            await until(lambda: router.statistics().routes)
        client = ControlClient(address)
        (route,) = await ask(client.routes)
        assert (route["system"], route["component"], route["endpoints"]) == (7, 1, ["ground"])
        (ground,) = await ask(client.endpoints)
        assert (ground["received"], ground["messages"]["HEARTBEAT"]) == (1, [1, 0])
        assert ground["sources"] == {"7/1": [1, 0]}


@pytest.mark.parametrize(
    ("method", "path", "body", "problem"),
    [
        ("POST", "/endpoints", {"url": URL}, "name is missing"),
        ("POST", "/endpoints", {"name": "x", "url": URL, "puase": True}, "did you mean pause"),
        ("POST", "/endpoints", {"name": "x", "url": "nonsense"}, "not usable"),
        ("POST", "/endpoints", {"name": "ground", "url": URL}, "already"),
        ("POST", "/endpoints", {"name": "x", "url": "udpin://192.0.2.1:1"}, "not an address of this machine"),
        ("POST", "/endpoints", {"name": "x", "record": "/tmp/x.tlog"}, "only network links"),
        ("POST", "/endpoints", {"name": "x", "url": "serial:///dev/ttyS0"}, "only network links"),
        ("POST", "/endpoints", {"name": "x", "url": "unixin:///tmp/x"}, "only network links"),
        ("PATCH", "/endpoints/ground", {"url": "file:///etc/passwd"}, "only network links"),
        ("POST", "/endpoints", {"name": "x", "url": "tls://127.0.0.1:1?ca=/etc/passwd"}, "leave out ca"),
        (
            "POST",
            "/endpoints",
            {"name": "x", "url": "wssin://127.0.0.1:0?cert=a&key=b"},
            "leave out cert, key",
        ),
        (
            "POST",
            "/endpoints",
            {"name": "x", "url": "sealed+tcpin://127.0.0.1:0?shared_key=/a"},
            "out shared_key",
        ),
        ("PATCH", "/endpoints/other", {}, "there is no endpoint other"),
        ("DELETE", "/endpoints/other", None, "there is no endpoint other"),
        ("POST", "/reload", None, "without a configuration file"),
        ("POST", "/endpoints", {"name": "x" * MAX_BODY}, "larger than"),
    ],
)
async def test_wrong_requests_are_refused_with_a_reason(method, path, body, problem):
    async with controlled() as (router, address):
        with pytest.raises(LinkError, match=problem):
            await ask(ControlClient(address).request, method, path, body)
        assert [each.name for each in router.config.endpoints] == ["ground"]


@pytest.mark.parametrize("scheme", [each for each in builtin_schemes().values() if each.is_network])
async def test_clients_without_a_token_open_links_of_every_network_scheme(scheme):
    """Those that lack a certificate or a key fail for that reason."""
    async with controlled() as (_, address):
        body = {"name": "x", "url": f"{scheme.name}://127.0.0.1:{0 if scheme.listens else 1}"}
        status, text = await post(address, "/endpoints", body)
        assert "control_token" not in text, status


async def post(address, path, body):
    """The status and the text of the answer to a request."""
    try:
        return 200, str(await ask(ControlClient(address).request, "POST", path, body))
    except LinkError as error:
        return 400, str(error)


async def test_a_token_is_needed_where_there_is_one(tmp_path):
    async with controlled(token="secret") as (router, address):
        for wrong in ("", "other", "sécret"):
            with pytest.raises(LinkError, match="a valid token is needed"):
                await ask(ControlClient(address, token=wrong.encode().decode("latin1")).endpoints)
        client = ControlClient(address, token="secret")
        await ask(client.add, "box", {"record": str(tmp_path / "flight.tlog")})
        assert router.endpoints["box"].files == [tmp_path / "flight.tlog"]


async def exchange(address, request):
    """The status of a raw HTTP request."""
    host, _, number = address.rpartition(":")
    reader, writer = await asyncio.open_connection(host, int(number))
    writer.write(request.replace("\n", "\r\n").encode())
    line = await asyncio.wait_for(reader.readline(), 5)
    writer.close()
    return int(line.split()[1])


@pytest.mark.parametrize(
    ("head", "status"),
    [
        ("GET /endpoints HTTP/1.1\nHost: 127.0.0.1:1\n\n", 200),
        ("GET /endpoints HTTP/1.1\nHost: localhost\n\n", 200),
        ("GET /endpoints HTTP/1.1\nHost: evil.example\n\n", 403),
        ("GET /endpoints HTTP/1.1\nHost: 127.0.0.1\nOrigin: https://evil.example\n\n", 403),
        ("POST /endpoints HTTP/1.1\nHost: 127.0.0.1\nContent-Type: text/plain\nContent-Length: 2\n\n{}", 415),
        (f"POST /endpoints HTTP/1.1\nHost: 127.0.0.1\nContent-Type: {JSON}\nContent-Length: 2\n\n[]", 400),
        ("DELETE /endpoints HTTP/1.1\nHost: 127.0.0.1\n\n", 405),
    ],
)  # fmt: skip
async def test_pages_in_a_browser_are_refused(head, status):
    async with controlled() as (_, address):
        assert await exchange(address, head) == status


async def test_the_api_describes_its_requests():
    async with controlled() as (_, address):
        document = await ask(ControlClient(address).request, "GET", "/openapi.json")
    body = document["components"]["schemas"]["AddEndpoint"]
    assert body["required"] == ["name"]
    keys = {"name", "url", "record", "group", "listen_only", "pause", "rate", "rates", "in", "out", "signing"}
    assert set(body["properties"]) >= keys
    assert set(document["paths"]["/endpoints/{name}"]) == {"patch", "delete"}


async def test_a_null_is_no_value():
    async with controlled() as (router, address):
        with pytest.raises(LinkError, match="url must be a string, got None"):
            await ask(ControlClient(address).change, "ground", {"url": None})
        assert router.config.endpoint("ground").url == URL


async def test_reload_calls_the_file():
    async def reload():
        return ("a note",)

    async with controlled(reload=reload) as (_, address):
        assert await ask(ControlClient(address).reload) == ["a note"]


async def test_metrics():
    async with controlled() as (router, address):
        with UdpPeer(port(router, "ground")) as peer:
            peer.send(heartbeat())
            await until(lambda: router.statistics().routes)
        host, _, number = address.rpartition(":")
        reader, writer = await asyncio.open_connection(host, int(number))
        writer.write(b"GET /metrics HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n")
        text = (await asyncio.wait_for(reader.read(), 5)).decode()
        writer.close()
    assert 'mavstack_router_received_packets_total{endpoint="ground"} 1.0' in text
    assert 'mavstack_router_up{endpoint="ground"} 1.0' in text
    message = 'message_packets_total{direction="in",endpoint="ground",message="HEARTBEAT"} 1.0'
    assert f"mavstack_router_{message}" in text
    assert "mavstack_router_routes 1.0" in text


async def test_without_metrics_there_is_no_such_page():
    async with controlled(metrics=False) as (_, address):
        assert await exchange(address, "GET /metrics HTTP/1.1\nHost: localhost\n\n") == 404


def test_a_client_with_the_token_is_authenticated_to_the_server(monkeypatch):
    marked = []
    monkeypatch.setattr("mavstack.router.control.app.mark_client", lambda *values: marked.append(values))
    api = ControlApi(cast("Any", None), token="secret", metrics=False)
    api._check(Request({"type": "http", "headers": [(b"authorization", b"Bearer secret")]}))
    assert [proof for proof, _ in marked] == [Proof.AUTHENTICATED]
    with pytest.raises(RefusedError):
        api._check(Request({"type": "http", "headers": [(b"authorization", b"Bearer guessed")]}))
    assert len(marked) == 1
