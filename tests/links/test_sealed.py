from __future__ import annotations

import asyncio
import logging
import os
import socket

import pytest

from mavstack import Node
from mavstack.errors import LinkError, LinkURLError
from mavstack.links import ChannelOpened, open_link
from mavstack.security import SigningKey, key_store
from mavstack.security.sealed.keys import public_key, read_private_key
from tests.waiting import wait_until

from .conformance import receive


@pytest.fixture(autouse=True)
def keys(tmp_path, monkeypatch):
    monkeypatch.setattr(key_store, "key_directory", lambda: tmp_path)
    for name in ("fleet.key", "other.key", "boat.sealed", "ground.sealed"):
        SigningKey.generate().save(tmp_path / name)
    return tmp_path


async def opened(link):
    async with asyncio.timeout(10):
        while not isinstance(event := await anext(link), ChannelOpened):
            pass
    return event.channel


PAIRS = [("sealed+udp", "sealed+udpout"), ("sealed+tcpin", "sealed+tcp")]


@pytest.mark.parametrize(("listening", "connecting"), PAIRS)
@pytest.mark.parametrize("options", ["shared_key=fleet", "shared_key=fleet&hybrid=yes&cipher=aes256"])
async def test_both_directions(listening, connecting, options):
    async with open_link(f"{listening}://127.0.0.1:0?{options}") as server:
        url = f"{connecting}://127.0.0.1:{server.address[1]}?{options}"
        async with open_link(url) as client:
            channel = await opened(client)
            assert [channel.write(data) for data in (b"to the server", b", joined")] == [True, True]
            back = await opened(server)
            assert await receive(server, 21) == b"to the server, joined"
            assert back.write(b"back")
            assert await receive(client, 4) == b"back"
            assert channel.name.startswith("sealed+")
            assert channel.counters.chunks_out == 2
            assert "fleet" not in client.url.redacted


async def test_pinned_keys_name_the_peer(keys):
    own = {name: public_key(read_private_key(name)).hex() for name in ("boat", "ground")}
    (keys / "peers.txt").write_text(f"{own['boat']} boat 7\n{'ab' * 32} other\n")
    async with open_link(f"sealed+udpin://127.0.0.1:0?private_key=ground&peer={keys}/peers.txt") as server:
        url = f"sealed+udpout://127.0.0.1:{server.address[1]}?private_key=boat&peer={own['ground']}"
        async with open_link(url):
            assert (await opened(server)).identity == "boat 7"


async def test_what_is_on_the_wire_is_sealed_and_joined():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as tap:
        tap.bind(("127.0.0.1", 0))
        tap.setblocking(False)
        loop = asyncio.get_running_loop()
        async with open_link("sealed+udpin://127.0.0.1:0?shared_key=fleet") as server:
            url = f"sealed+udpout://127.0.0.1:{tap.getsockname()[1]}?shared_key=fleet&mtu=520"
            async with open_link(url) as client:
                wire, far = [], ("127.0.0.1", server.address[1])

                async def relay():
                    near = None
                    while True:
                        data, address = await loop.sock_recvfrom(tap, 65536)
                        near = address if address != far else near
                        wire.append(data)
                        await loop.sock_sendto(tap, data, far if address != far else near)

                task = asyncio.create_task(relay())
                channel = await opened(client)
                await opened(server)
                wire.clear()
                for _ in range(10):
                    channel.write(b"secret" * 16)
                assert await receive(server, 960) == b"secret" * 160
                frames = [len(data) for data in wire if len(data) > 20]
                task.cancel()
    assert frames == [500, 500]  # 5 packets of 96 bytes and 20 more bytes in each
    assert not any(b"secret" in data for data in wire)


async def test_unknown_hosts_open_no_channel_and_are_counted():
    async with open_link("sealed+udpin://127.0.0.1:0?shared_key=fleet") as server:
        address = f"127.0.0.1:{server.address[1]}"
        async with (
            open_link(f"sealed+udpout://{address}?shared_key=other"),
            open_link(f"udpout://{address}") as plain,
        ):
            plain.channels[0].write(b"\xfd plain MAVLink")
            plain.channels[0].write(b"\x01 junk")
            await wait_until(
                lambda: server.refusals["forged or unknown key"] and server.refusals["malformed"]
            )
            assert not server.channels
            async with open_link(f"sealed+udpout://{address}?shared_key=fleet"):
                await opened(server)


async def test_a_serial_port_resynchronises(keys):
    pytest.importorskip("serial")
    pty = pytest.importorskip("pty")
    ends = [pty.openpty() for _ in range(2)]
    loop = asyncio.get_running_loop()
    noise = [b"\x01\x02junk"]

    def forward(source: int, target: int) -> None:
        data = os.read(source, 4096)
        os.write(target, (noise.pop() if noise else b"") + data)

    loop.add_reader(ends[0][0], forward, ends[0][0], ends[1][0])
    loop.add_reader(ends[1][0], forward, ends[1][0], ends[0][0])
    urls = [f"sealed+serial://{os.ttyname(slave)}?shared_key=fleet" for _, slave in ends]
    try:
        async with open_link(urls[0]) as one, open_link(urls[1]) as other:
            first, second = await opened(one), await opened(other)
            first.write(b"\0to\0")
            assert await receive(other, 4) == b"\0to\0"
            second.write(b"back")
            assert await receive(one, 4) == b"back"
    finally:
        for master, slave in ends:
            loop.remove_reader(master)
            os.close(master)
            os.close(slave)


async def test_nodes_meet_over_a_sealed_link():
    server = open_link("sealed+udpin://127.0.0.1:0?shared_key=fleet")
    async with Node(server, system=1, component=1) as vehicle:
        url = f"sealed+udpout://127.0.0.1:{server.address[1]}?shared_key=fleet"
        async with Node(url, system=255, component=190) as station:
            found = await station.wait_for_component(lambda info: info.address.system == 1, timeout=10)
            assert found.address == vehicle.address


async def test_a_peer_that_does_not_answer_is_reported_in_the_log(monkeypatch, caplog):
    monkeypatch.setattr("mavstack.links.sealed.WARN_ATTEMPTS", 1)
    with caplog.at_level(logging.WARNING, "mavstack.links"):
        async with open_link("sealed+udpout://127.0.0.1:9?shared_key=fleet"):
            await asyncio.sleep(0.05)
    assert "no answer to 1 handshakes with 127.0.0.1:9: does the other end use the same keys" in caplog.text


@pytest.mark.parametrize(
    "query",
    ["", "shared_key=fleet&private_key=boat", "private_key=boat", "shared_key=fleet&peer=" + "ab" * 32],
)
def test_a_link_needs_exactly_one_kind_of_key(query):
    with pytest.raises(LinkURLError, match="a sealed link needs a key"):
        open_link(f"sealed+udpout://127.0.0.1:1?{query}")


@pytest.mark.parametrize(
    ("query", "problem"),
    [
        ("shared_key=nobody", "there is no signing key 'nobody'"),
        (f"private_key=nobody&peer={'ab' * 32}", "there is no key 'nobody' of sealed links"),
        ("private_key=boat&peer=nobody", "cannot read the public keys nobody"),
        (f"private_key=boat&peer={'ab' * 32},{'cd' * 32}", "needs one public key in peer="),
        ("shared_key=fleet&cipher=des", "one of chacha20, aes256"),
        ("shared_key=fleet&shared_keys=x", "has no option 'shared_keys'"),
    ],
)
def test_mistakes_are_named(query, problem):
    with pytest.raises(LinkError, match=problem):
        open_link(f"sealed+udpout://127.0.0.1:1?{query}")
