from __future__ import annotations

import asyncio
import logging

import pytest

from mavstack.links import Impairment, impair, memory_pair, open_link
from mavstack.links.link_log import LinkLog
from mavstack.links.url import parse_url

from .peers import Acceptor, UdpPeer


@pytest.fixture
def records(caplog):
    caplog.set_level(logging.DEBUG, "mavstack.links")
    return lambda: [(record.levelname, record.getMessage()) for record in caplog.records]


async def test_links_and_channels_are_logged(records):
    one, other = memory_pair()
    async with one, other:
        pass
    assert records() == [
        ("INFO", "memory://pair: link opened"),
        ("INFO", "memory://pair: channel memory pair#1 opened"),
        ("INFO", "memory://pair: channel memory pair#2 opened"),
        ("INFO", "memory://pair: link opened"),
        ("INFO", "memory://pair: channel memory pair#2 closed: closed by the peer"),
        ("INFO", "memory://pair: channel memory pair#1 closed: link closed"),
        ("INFO", "memory://pair: link closed"),
        ("INFO", "memory://pair: link closed"),
    ]


async def test_reconnections_are_logged_with_their_delays(records):
    acceptor = Acceptor()
    port = await acceptor.listen_tcp()
    url = f"tcpout://127.0.0.1:{port}?retry=1ms"
    async with open_link(url) as link:
        await acceptor.close()
        for _ in range(5):
            await anext(link)
    link_down_records = [record for record in records() if "link down" in record[1]]
    assert link_down_records[0] == (
        "WARNING",
        f"{link.url}: link down: closed by the peer; next attempt in 0.001 s",
    )
    assert link_down_records[1][0] == "INFO"
    assert link_down_records[1][1].endswith("next attempt in 0.002 s")


async def test_dropped_datagrams_are_logged_at_a_limited_rate(records):
    async with open_link("udpin://127.0.0.1:0?receive_queue=1k") as link:
        peer = UdpPeer(link.address)
        for _ in range(20):
            await peer.send(bytes(500))
        await asyncio.sleep(0.01)
        assert link.counters.dropped_in > 1
        await peer.close()
    drop_records = [record for record in records() if "dropped" in record[1]]
    assert drop_records == [("WARNING", "udpin://127.0.0.1:0?receive_queue=1k: 1 received chunks dropped")]


async def test_an_impaired_link_is_logged_once(records):
    inner, other = memory_pair()
    async with impair(inner, Impairment()), other:
        pass
    assert [text for _, text in records()].count("memory://pair: link closed") == 2


def test_secrets_are_not_logged(records):
    LinkLog(parse_url("tcpout://h:1?token=hunter2")).link_opened()
    assert records() == [("INFO", "tcpout://h:1?token=***: link opened")]


def test_nothing_is_printed_without_configuration():
    assert any(isinstance(handler, logging.NullHandler) for handler in logging.getLogger("mavstack").handlers)
