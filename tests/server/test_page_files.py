from __future__ import annotations

import gzip
from typing import TYPE_CHECKING

import pytest

from mavstack.server.access import Access
from mavstack.server.app import SCRIPT_POLICY, make_app
from mavstack.server.station import Station
from tests.server.asgi import ApiClient

if TYPE_CHECKING:
    from pathlib import Path

SCRIPT = b"run()" * 1000


@pytest.fixture
def api(tmp_path: Path) -> ApiClient:
    for folder in (".", "assets", "sandbox"):
        (tmp_path / folder).mkdir(exist_ok=True)
        (tmp_path / folder / "app.js").write_bytes(SCRIPT)
        (tmp_path / folder / "app.js.gz").write_bytes(gzip.compress(SCRIPT))
    (tmp_path / "icon.svg").write_text("<svg/>")
    return ApiClient(make_app(Station(), Access(), static=tmp_path))


@pytest.mark.parametrize("accepted", ["gzip", "br, gzip", "deflate, gzip;q=0.5", "*"])
async def test_files_are_sent_as_the_build_compressed_them(api: ApiClient, accepted: str) -> None:
    answer = await api.get("/app.js", headers={"accept-encoding": accepted})
    assert answer.headers["content-encoding"] == "gzip"
    assert answer.headers["content-type"].startswith("text/javascript")
    assert answer.headers["content-security-policy"] != SCRIPT_POLICY
    assert gzip.decompress(answer.data) == SCRIPT
    assert answer.headers["vary"] == "Accept-Encoding"


@pytest.mark.parametrize("accepted", ["", "identity", "br", "gzip;q=0", "gzip; q=0.000", "*;q=0"])
async def test_clients_that_do_not_take_them_get_the_others(api: ApiClient, accepted: str) -> None:
    answer = await api.get("/app.js", headers={"accept-encoding": accepted})
    assert "content-encoding" not in answer.headers
    assert (answer.data, answer.headers["vary"]) == (SCRIPT, "Accept-Encoding")


async def test_files_that_the_build_did_not_compress(api: ApiClient) -> None:
    answer = await api.get("/icon.svg", headers={"accept-encoding": "gzip"})
    assert (answer.data, "content-encoding" in answer.headers) == (b"<svg/>", False)


async def test_scripts_of_users_have_their_policy_compressed_too(api: ApiClient) -> None:
    answer = await api.get("/sandbox/app.js", headers={"accept-encoding": "gzip"})
    assert (answer.headers["content-encoding"], gzip.decompress(answer.data)) == ("gzip", SCRIPT)
    assert answer.headers["content-security-policy"] == SCRIPT_POLICY


async def test_browsers_keep_files_whose_names_change_with_their_content(api: ApiClient) -> None:
    assert "immutable" in (await api.get("/assets/app.js")).headers["cache-control"]
    assert "cache-control" not in (await api.get("/app.js")).headers


async def test_a_file_that_a_browser_has_is_not_sent_again(api: ApiClient) -> None:
    headers = {"accept-encoding": "gzip"}
    first = await api.get("/app.js", headers=headers)
    again = await api.get("/app.js", headers={**headers, "if-none-match": first.headers["etag"]})
    assert (again.status, again.data) == (304, b"")
