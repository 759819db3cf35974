from __future__ import annotations

import asyncio

import pytest

from mavstack.http.bodies import MAX_BODY
from mavstack.links.scheme_table import builtin_schemes
from mavstack.security.roles import Role
from mavstack.server.access import Access
from mavstack.server.app import ROUTES, SCRIPT_POLICY, make_app
from mavstack.server.station import Station
from mavstack.sim.virtual import run_virtually
from tests.server.asgi import ApiClient
from tests.server.stations import Ground, serve

PASSWORDS = {Role.OPERATE: "may fly it"}


@pytest.fixture
def pages(tmp_path):
    (tmp_path / "index.html").write_text("<title>station</title>")
    (tmp_path / "app.js").write_text("run()")
    (tmp_path / "sandbox").mkdir()
    (tmp_path / "sandbox" / "worker.js").write_text("eval(text)")
    return tmp_path


async def test_the_pages_and_their_headers(pages) -> None:
    api = ApiClient(make_app(Station(), Access(), static=pages))
    index = await api.get("/")
    assert (index.status, index.data) == (200, b"<title>station</title>")
    assert "default-src 'self'" in index.headers["content-security-policy"]
    assert index.headers["x-content-type-options"] == "nosniff"
    assert (await api.get("/app.js")).data == b"run()"
    assert (await api.get("/../pyproject.toml")).status == 404


async def test_the_worker_of_scripts_has_a_policy_of_its_own_also_from_the_cache(pages) -> None:
    api = ApiClient(make_app(Station(), Access(), static=pages))
    first = await api.get("/sandbox/worker.js")
    again = await api.get("/sandbox/worker.js", headers={"if-none-match": first.headers["etag"]})
    assert (first.status, again.status, first.data) == (200, 304, b"eval(text)")
    for answer in (first, again):
        assert answer.headers["content-security-policy"] == SCRIPT_POLICY
        assert "default-src 'none'" in SCRIPT_POLICY
    assert (await api.get("/sandbox/../app.js")).status == 404


async def test_without_pages_the_answer_names_the_command_that_builds_them() -> None:
    answer = await ApiClient(make_app(Station(), Access(), static=None)).get("/")
    assert (answer.status, b"make station" in answer.data) == (503, True)


async def test_a_request_for_the_websocket_needs_an_upgrade() -> None:
    answer = await ApiClient(make_app(Station(), Access(), static=None)).get("/ws")
    assert (answer.status, answer.kind, answer.headers["upgrade"]) == (426, "UpgradeRequired", "websocket")
    assert answer.problem == "/ws is a WebSocket: send the request with an upgrade"


def test_observers_use_only_requests_that_change_nothing() -> None:
    found = {f"{each.method} {each.path}" for each in ROUTES if each.role is Role.OBSERVE}
    assert {each for each in found if not each.startswith("GET ")} == {
        "POST /api/messages",  # its handler permits requests for messages alone
        "POST /api/searches",
        "POST /api/surveys",
        "POST /api/swarm/preview",
        "POST /api/video/whep",
        "DELETE /api/video/whep/{viewer}",
        "DELETE /api/tasks/{id}",  # its handler ends tasks of this session alone
    }


async def test_unknown_routes_and_methods() -> None:
    api = ApiClient(make_app(Station(), Access(), static=None))
    unknown = await api.get("/api/nothing")
    assert (unknown.status, unknown.kind, unknown.problem) == (404, "NotFound", "/api/nothing does not exist")
    method = await api.put("/api/vehicles")
    assert (method.status, method.kind, "GET" in method.headers["allow"]) == (405, "MethodNotAllowed", True)


async def test_pages_of_other_sites_are_refused() -> None:
    api = ApiClient(make_app(Station(), Access(), static=None))
    for path in ("/", "/openapi.json", "/api/vehicles", "/api/session"):
        assert (await api.get(path, headers={"host": "evil.example"})).status == 403
        assert (await api.get(path, headers={"origin": "https://evil.example"})).status == 403


async def test_requests_that_pages_of_other_sites_make_without_an_origin_are_refused() -> None:
    """A page can request a picture from any address; a request could make the station ask a vehicle."""
    api = ApiClient(make_app(Station(), Access(), static=None))
    for site, status in (("cross-site", 403), ("same-site", 403), ("same-origin", 200), ("none", 200)):
        assert (await api.get("/api/vehicles", headers={"sec-fetch-site": site})).status == status
    assert (await api.get("/", headers={"sec-fetch-site": "cross-site"})).status == 503  # a link to the page


async def test_pages_of_a_given_origin_use_the_api() -> None:
    origin = "https://pages.example"
    api = ApiClient(make_app(Station(), Access(origins=[f"{origin}/"]), static=None))
    answer = await api.get("/api/vehicles", headers={"origin": origin, "sec-fetch-site": "cross-site"})
    assert (answer.status, answer.headers["access-control-allow-origin"]) == (200, origin)
    asked = {"origin": origin, "access-control-request-method": "POST"}
    asked["access-control-request-headers"] = "content-type"
    assert (await api.request("OPTIONS", "/api/sources", headers=asked)).status == 200
    other = await api.request("OPTIONS", "/api/sources", headers=asked | {"origin": "https://evil.example"})
    assert "access-control-allow-origin" not in other.headers
    closed = ApiClient(make_app(Station(), Access(), static=None))
    assert (await closed.request("OPTIONS", "/api/sources", headers=asked)).status == 405


@pytest.mark.parametrize(
    ("options", "status"),
    [
        ({"data": b"{}", "headers": {"content-type": "text/plain"}}, 415),
        ({"data": b"{", "headers": {"content-type": "application/json"}}, 400),
        ({"body": {"url": "x" * MAX_BODY}}, 413),
        ({"body": {"url": 5}}, 400),
        ({}, 400),
    ],
)
async def test_wrong_bodies(options, status) -> None:
    api = ApiClient(make_app(Station(), Access(), static=None))
    assert (await api.request("POST", "/api/sources", **options)).status == status


async def test_sessions() -> None:
    api = ApiClient(make_app(Station(), Access(passwords=PASSWORDS, local=False), static=None))
    assert (await api.get("/api/session")).status == 401
    wrong = await api.post("/api/session", {"password": "nonsense"})
    assert (wrong.status, wrong.headers["www-authenticate"]) == (401, "Bearer")
    assert (await api.post("/api/session", {})).status == 400
    begun = await api.post("/api/session", {"password": "may fly it"})
    assert (begun.status, begun.json["role"]) == (201, "operate")
    cookie = begun.headers["set-cookie"]
    assert all(word in cookie for word in ("HttpOnly", "SameSite=strict"))
    api.headers = {"cookie": cookie.partition(";")[0]}
    shown = (await api.get("/api/session")).json
    assert shown["ticket"] != begun.json["ticket"]
    assert (await api.delete("/api/session")).status == 200
    assert (await api.get("/api/session")).status == 401


async def test_without_passwords_all_clients_of_this_machine_administer() -> None:
    api = ApiClient(make_app(Station(), Access(), static=None))
    assert (await api.get("/api/session")).json == {
        "role": "administer",
        "needs_password": False,
        "ticket": None,
    }


def test_clients_without_a_password_open_no_files() -> None:
    async def scenario(ground: Ground) -> None:
        ground.station.sources._network_only = True
        for url in ("file:///etc/passwd", "unixin:///tmp/x", "/etc/passwd"):
            answer = await ground.api.post("/api/sources", {"url": url})
            assert (answer.status, "only links of the network" in answer.problem) == (403, True)
        added = await ground.api.post("/api/sources", {"url": "udpin://127.0.0.1:0"})
        assert (added.status, added.json["state"]) == (201, "waiting")

    serve((), scenario)


def test_clients_without_a_password_open_links_of_every_network_scheme() -> None:
    """Those that lack a certificate or a key fail for that reason."""

    async def scenario(ground: Ground) -> None:
        ground.station.sources._network_only = True
        for scheme in builtin_schemes().values():
            if scheme.is_network:
                url = f"{scheme.name}://127.0.0.1:{0 if scheme.listens else 1}"
                answer = await ground.api.post("/api/sources", {"url": url})
                assert b"only links of the network" not in answer.data, url

    serve((), scenario)


async def test_clients_that_leave_in_the_middle_of_a_request_are_no_defects(caplog) -> None:
    app = make_app(Station(), Access(), static=None)
    for path in ("/api/session", "/api/sources"):
        headers = {"host": "localhost", "content-type": "application/json", "content-length": "9"}
        scope = ApiClient(app)._scope("http", "POST", path, headers)
        events = [{"type": "http.disconnect"}, {"type": "http.request", "body": b"{", "more_body": True}]
        answers: list[dict[str, object]] = []

        async def receive(events=events):
            return events.pop()

        async def send(message, answers=answers):
            answers.append(message)

        await app(scope, receive, send)
        assert answers[0]["status"] == 400
    assert not caplog.records  # a client cannot fill the log


def test_a_log_in_that_does_not_arrive_is_ended() -> None:
    """It needs no session, so that any client could hold connections with it."""

    async def run() -> None:
        app = make_app(Station(), Access(passwords=PASSWORDS, local=False), static=None)
        headers = {"host": "station", "content-type": "application/json", "content-length": "9"}
        scope = ApiClient(app)._scope("http", "POST", "/api/session", headers)
        answers: list[dict[str, object]] = []

        async def receive():
            await asyncio.Event().wait()

        async def send(message):
            answers.append(message)

        await app(scope, receive, send)
        assert answers[0]["status"] == 408

    run_virtually(run())
