from __future__ import annotations

import pytest

from mavstack.http.web_origin import host_of, is_local_host, is_loopback, is_own_origin


@pytest.mark.parametrize(
    ("header", "host", "local"),
    [
        ("localhost", "localhost", True),
        ("LOCALHOST:8080", "localhost", True),
        ("127.0.0.1:80", "127.0.0.1", True),
        ("[::1]:8080", "::1", True),
        ("[::1]", "::1", True),
        ("evil.example:8080", "evil.example", False),
        ("localhost.evil.example", "localhost.evil.example", False),
        ("user@evil.example", "evil.example", False),
        ("[::1", "", False),
        ("", "", False),
    ],
)
def test_the_name_in_a_host_header(header, host, local):
    assert (host_of(header), is_local_host(header)) == (host, local)


@pytest.mark.parametrize(
    ("origin", "own"),
    [
        ("http://localhost:8080", True),
        ("https://LocalHost:8080", True),
        ("http://localhost", False),
        ("http://evil.example", False),
        ("null", False),
        ("ftp://localhost:8080", False),
        ("", False),
    ],
)
def test_an_origin_is_that_of_the_servers_own_pages(origin, own):
    assert is_own_origin(origin, "localhost:8080") is own


def test_without_a_host_no_origin_is_own():
    assert not is_own_origin("http://", "")


def test_loopback_addresses():
    assert all(map(is_loopback, ("localhost", "127.0.0.1", "127.3.2.1", "::1", "[::1]")))
    assert not any(map(is_loopback, ("0.0.0.0", "::", "192.168.1.2", "example.com", "")))
