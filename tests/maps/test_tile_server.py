from __future__ import annotations

import asyncio

import pytest

from mavstack.errors import InvalidArgumentError
from mavstack.maps import MapError, Tile, TileServer
from mavstack.maps.terms import terms_of
from mavstack.maps.tile_server import MAX_TILE, USER_AGENT
from tests.maps.tile_pages import picture, tile_pages

TILE = Tile(3, 4, 2)


def test_a_tile_is_requested_by_its_place_and_with_a_name():
    with tile_pages() as pages:
        answer = asyncio.run(TileServer(pages.template).fetch(TILE))
    assert (answer.data, answer.format, answer.retry_after) == (picture(*TILE)[1], "png", None)
    assert (pages.requested, pages.agents) == (["/3/4/2.png"], {USER_AGENT})


@pytest.mark.parametrize("status", [204, 404, 410])
def test_a_tile_that_the_server_does_not_have(status):
    with tile_pages(lambda *_: (status, b"", {})) as pages:
        answer = asyncio.run(TileServer(pages.template).fetch(TILE))
    assert (answer.data, answer.retry_after) == (b"", None)


def test_a_busy_server_names_the_time():
    with tile_pages(lambda *_: (503, b"", {"Retry-After": "7"})) as pages:
        answer = asyncio.run(TileServer(pages.template).fetch(TILE))
        assert (answer.retry_after, answer.reason) == (7.0, "503 Service Unavailable")
        pages.answer = lambda *_: (429, b"", {"Retry-After": "Wed, 21 Oct 2026 07:28:00 GMT"})
        assert asyncio.run(TileServer(pages.template).fetch(TILE)).retry_after == 0.0
    gone = asyncio.run(TileServer(pages.template).fetch(TILE))
    assert gone.retry_after == 0.0
    assert "Connection refused" in gone.reason


@pytest.mark.parametrize(
    ("answer", "reason"),
    [
        ((403, b"", {}), "403 Forbidden; does the address need a key"),
        ((200, b"<html>", {"Content-Type": "text/html"}), "it sent text/html, not a picture"),
        ((200, bytes(MAX_TILE + 1), {"Content-Type": "image/png"}), "a tile has more than 4 MiB"),
        ((418, b"", {}), "418 I'm a Teapot"),
    ],
    ids=["forbidden", "page", "large", "strange"],
)
def test_answers_that_end_a_download(answer, reason):
    with tile_pages(lambda *_: answer) as pages, pytest.raises(MapError) as caught:
        asyncio.run(TileServer(f"{pages.template}?key=secret").fetch(TILE))
    assert str(caught.value).startswith(f"downloading tiles from 127.0.0.1 failed: {reason}")
    assert "secret" not in str(caught.value)


def test_vectors_without_compression():
    kind = {"Content-Type": "application/vnd.mapbox-vector-tile"}
    with tile_pages(lambda *_: (200, b"\x1a\x05", kind)) as pages:
        assert asyncio.run(TileServer(pages.template).fetch(TILE)).format == "pbf"


@pytest.mark.parametrize(
    "url",
    ["", "file:///{z}/{x}/{y}", "ftp://a/{z}/{x}/{y}", "https:///{z}/{x}/{y}", "http://a/{z}/{x}", "http://[/{z}/{x}/{y}",
     "http://a/ {z}/{x}/{y}", "http://a/\n{z}/{x}/{y}", "http://a..b/{z}/{x}/{y}", "http://a:99999/{z}/{x}/{y}",
     "http://a:b/{z}/{x}/{y}", "http://user:secret@a/{z}/{x}/{y}"],
)  # fmt: skip
def test_wrong_addresses(url):
    with pytest.raises(InvalidArgumentError, match="the address of the tiles") as caught:
        TileServer(url)
    assert "secret" not in str(caught.value)


def test_a_redirect_to_no_url():
    with tile_pages(lambda *_: (302, b"", {"Location": "http://a..b/1.png"})) as pages:
        answer = asyncio.run(TileServer(pages.template).fetch(TILE))
    assert answer.retry_after == 0.0
    assert "idna" in answer.reason


def test_terms():
    forbidden = (
        "tile.openstreetmap.org",
        "a.TILE.openstreetmap.org.",
        "mt1.google.com",
        "ecn.t3.tiles.virtualearth.net",
    )
    assert not any(terms_of(host).allowed for host in forbidden)
    assert terms_of("notopenstreetmap.org").allowed
    assert "open data" in terms_of("s3.amazonaws.com", "/elevation-tiles-prod/terrarium/1/1/1.png").text
    assert "the owner of the server decides" in terms_of("s3.amazonaws.com", "/other").text
    assert terms_of("localhost").text == "the server is on this machine"
