"""Socket addresses: IP addresses are resolved without a thread, names with one."""

from __future__ import annotations

import asyncio
import socket

import pytest

from mavstack.links.address import (
    is_loopback,
    is_multicast,
    local_address,
    packed_ip,
    resolve,
    resolve_datagram,
)


@pytest.mark.parametrize(
    ("host", "family"), [("127.0.0.1", socket.AF_INET), ("0.0.0.0", socket.AF_INET), ("::1", socket.AF_INET6)]
)
async def test_an_ip_address_needs_no_look_up(monkeypatch, host, family):
    monkeypatch.setattr(asyncio.BaseEventLoop, "getaddrinfo", lambda *_, **__: pytest.fail("a look-up"))
    found, address = await resolve_datagram(host, 14550)
    assert (found, address[:2]) == (family, (host, 14550))


@pytest.mark.parametrize("host", ["localhost", "bücher.example"])
async def test_a_name_is_looked_up(monkeypatch, host):
    asked = []

    async def look_up(_loop, host, port, *, type):  # noqa: A002 (the name of the argument of asyncio)
        asked.append((host, port, type))
        return [(socket.AF_INET, type, 17, "", ("192.0.2.1", port))]

    monkeypatch.setattr(asyncio.BaseEventLoop, "getaddrinfo", look_up)
    assert await resolve(host, 5760, socket.SOCK_STREAM) == [(socket.AF_INET, ("192.0.2.1", 5760))]
    assert asked == [(host, 5760, socket.SOCK_STREAM)]


@pytest.mark.parametrize(
    ("host", "local", "loopback", "multicast"),
    [
        ("127.1.2.3", "127.0.0.1", True, False),
        ("192.0.2.1", "0.0.0.0", False, False),
        ("224.0.0.1", "0.0.0.0", False, True),
        ("239.255.255.255", "0.0.0.0", False, True),
        ("240.0.0.1", "0.0.0.0", False, False),
        ("::1", "::1", True, False),
        ("fe80::1%eth0", "::", False, False),
        ("ff02::1", "::", False, True),
    ],
)
def test_loopback_and_multicast_addresses(host, local, loopback, multicast):
    packed = packed_ip((host, 14550))
    assert (local_address((host, 14550)), is_loopback(host), is_multicast(packed)) == (
        local,
        loopback,
        multicast,
    )


@pytest.mark.parametrize("text", ["", "localhost", "127.0.0", "127.0.0.1.2", "bücher.example", "127.0.0.1\0"])
def test_other_texts_are_not_loopback_addresses(text):
    assert not is_loopback(text)
