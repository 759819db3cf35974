from __future__ import annotations

import asyncio
import os
import socket
import sys

import pytest

from mavstack.errors import LinkError
from mavstack.links import open_link
from mavstack.router import RouterEngine
from mavstack.router.config import EndpointConfig
from mavstack.router.endpoints import DOWN, ENDED, LISTENING, OPEN
from mavstack.router.endpoints.native import MIN_LINE_QUEUE, queue_of_line
from tests.router.peers import TIMEOUT, UdpPeer, heartbeat, port, routing, until

VEHICLE = EndpointConfig("vehicle", "udpin://127.0.0.1:0")
TCP = EndpointConfig("tcp", "tcpin://127.0.0.1:0")
posix = pytest.mark.skipif(sys.platform == "win32", reason="POSIX only")


async def read(reader, size):
    async with asyncio.timeout(TIMEOUT):
        return await reader.readexactly(size)


async def test_each_client_of_a_tcp_server_has_routes_of_its_own():
    async with routing(TCP) as router:
        endpoint = router.endpoints["tcp"]
        first = await asyncio.open_connection("127.0.0.1", port(router, "tcp"))
        second = await asyncio.open_connection("127.0.0.1", port(router, "tcp"))
        await until(lambda: len(endpoint.numbers) == 2)
        first[1].write(heartbeat())
        assert await read(second[0], len(heartbeat())) == heartbeat()
        (route,) = router.statistics().routes
        assert len(route.endpoints) == 1
        first[1].close()
        await until(lambda: len(endpoint.numbers) == 1)
        second[1].close()
        await until(lambda: endpoint.state == LISTENING)


async def test_small_packets_are_sent_without_delay(monkeypatch):
    descriptors, add = [], RouterEngine.add_stream
    monkeypatch.setattr(
        RouterEngine,
        "add_stream",
        lambda self, fd, **options: descriptors.append(no_delay(fd)) or add(self, fd, **options),
    )
    async with routing(TCP) as router:
        url = f"tcpout://127.0.0.1:{port(router, 'tcp')}"
        async with routing(EndpointConfig("client", url)):
            await until(lambda: len(descriptors) == 2)
    assert descriptors == [True, True]


def no_delay(descriptor):
    with socket.socket(fileno=os.dup(descriptor)) as opened:
        return bool(opened.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY))


async def test_the_send_queue_of_streams_is_the_one_of_their_urls(monkeypatch):
    sizes, add = {}, RouterEngine.add_stream
    monkeypatch.setattr(
        RouterEngine,
        "add_stream",
        lambda self, fd, **options: (
            sizes.update({options["name"].split()[0]: options["queue_bytes"]}) or add(self, fd, **options)
        ),
    )
    async with routing(EndpointConfig("server", f"{TCP.url}?send_queue=3000")) as router:
        url = f"tcpout://127.0.0.1:{port(router, 'server')}?send_queue=5k"
        async with routing(EndpointConfig("client", url)):
            await until(lambda: len(sizes) == 2)
    assert sizes == {"server": 3000, "client": 5 << 10}


async def test_a_slow_tcp_client_has_no_more_than_its_send_queue_waiting():
    async with routing(VEHICLE, EndpointConfig("tcp", f"{TCP.url}?send_queue=2000")) as router:
        endpoint = router.endpoints["tcp"]
        with UdpPeer(port(router, "vehicle")) as vehicle:
            slow = socket.socket()
            slow.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            slow.connect(("127.0.0.1", port(router, "tcp")))
            await until(lambda: endpoint.numbers)
            (number,) = endpoint.numbers

            def counted():
                return router.statistics().endpoints[number]

            while not counted().dropped.get("full_queue"):
                for _ in range(50):
                    vehicle.send(heartbeat() * 60)
                await asyncio.sleep(0)
            assert 0 < counted().queued <= 2000
            slow.close()


async def test_silent_connections_lock_no_client_out_of_a_tcp_server():
    """Before: 64 of them filled the endpoint, and every further client was refused."""
    async with routing(EndpointConfig("tcp", "tcpin://127.0.0.1:0?max_peers=4")) as router:
        endpoint = router.endpoints["tcp"]
        silent = [await asyncio.open_connection("127.0.0.1", port(router, "tcp")) for _ in range(4)]
        await until(lambda: len(endpoint.numbers) == 4)
        _, pilot = await asyncio.open_connection("127.0.0.1", port(router, "tcp"))
        await until(lambda: endpoint.replaced == 1)
        assert await silent[0][0].read() == b""
        pilot.write(heartbeat(255, 190))
        await until(lambda: router.statistics().routes)
        assert (endpoint.refused, len(endpoint.numbers)) == (0, 4)
        for writer in (pilot, *(writer for _, writer in silent)):
            writer.close()


async def test_a_full_tcp_server_keeps_clients_that_send_packets():
    async with routing(EndpointConfig("tcp", "tcpin://127.0.0.1:0?max_peers=1")) as router:
        endpoint = router.endpoints["tcp"]
        _, writer = await asyncio.open_connection("127.0.0.1", port(router, "tcp"))
        writer.write(heartbeat())
        await until(lambda: router.statistics().routes)
        refused, other = await asyncio.open_connection("127.0.0.1", port(router, "tcp"))
        assert await refused.read() == b""
        assert (endpoint.refused, endpoint.replaced) == (1, 0)
        writer.close()
        other.close()


@posix
@pytest.mark.parametrize("framing", ["none", "length"])
async def test_unix_clients(tmp_path, framing):
    path = tmp_path / "mav.sock"
    frame = len(heartbeat()).to_bytes(4, "big") if framing == "length" else b""
    async with routing(VEHICLE, EndpointConfig("unix", f"unixin://{path}?framing={framing}")) as router:
        with UdpPeer(port(router, "vehicle")) as vehicle:
            reader, writer = await asyncio.open_unix_connection(path)
            await until(lambda: router.endpoints["unix"].numbers)
            vehicle.send(heartbeat())
            assert await read(reader, len(frame + heartbeat())) == frame + heartbeat()
            writer.write(frame + heartbeat(255))
            assert await vehicle.receive() == heartbeat(255)
            writer.close()
    assert not path.exists()


@posix
async def test_a_slow_unix_client_loses_its_own_packets_alone(tmp_path):
    path = tmp_path / "mav.sock"
    async with routing(VEHICLE, EndpointConfig("unix", f"unixin://{path}?framing=length")) as router:
        with UdpPeer(port(router, "vehicle")) as vehicle:
            slow = await asyncio.open_unix_connection(path, limit=1)
            quick = await asyncio.open_unix_connection(path)
            await until(lambda: len(router.endpoints["unix"].numbers) == 2)
            slow[1].transport.pause_reading()
            numbers = list(router.endpoints["unix"].numbers)
            sent = 0
            while not router.statistics().endpoints[numbers[0]].dropped.get("full_queue"):
                for _ in range(500):
                    vehicle.send(heartbeat(sequence=sent % 256) * 30)
                    sent += 30
                await read(quick[0], (len(heartbeat()) + 4) * 15_000)
            assert not router.statistics().endpoints[numbers[1]].dropped
            for _, writer in (slow, quick):
                writer.transport.abort()


@posix
async def test_a_path_that_another_program_serves_is_an_error(tmp_path):
    config = EndpointConfig("unix", f"unixin://{tmp_path}/mav.sock")
    async with routing(config):
        with pytest.raises(LinkError, match="another program listens"):
            async with routing(config):
                pass


async def serve_once(received):
    """A TCP server that sends a heartbeat to each client, and counts them."""

    async def accept(reader, writer):
        received.append(writer)
        writer.write(heartbeat())

    return await asyncio.start_server(accept, "127.0.0.1", 0)


async def test_a_lost_connection_is_opened_again():
    clients = []
    server = await serve_once(clients)
    address = server.sockets[0].getsockname()
    config = EndpointConfig("server", f"tcpout://127.0.0.1:{address[1]}?retry=10ms")
    async with routing(config, VEHICLE) as router:
        endpoint = router.endpoints["server"]
        assert endpoint.state == OPEN
        await until(lambda: clients)
        clients[0].close()
        await until(lambda: len(clients) == 2)
        await until(lambda: endpoint.reconnections == 1)
        await until(lambda: endpoint.state == OPEN)
        for writer in clients:
            writer.close()
    server.close()


async def test_without_reconnecting_the_endpoint_ends():
    clients = []
    server = await serve_once(clients)
    address = server.sockets[0].getsockname()
    async with routing(
        EndpointConfig("server", f"tcpout://127.0.0.1:{address[1]}?reconnect=no"), VEHICLE
    ) as router:
        await until(lambda: clients)
        clients[0].close()
        await until(lambda: router.endpoints["server"].state == ENDED)
        assert router.endpoints["server"].reason
    server.close()


async def test_a_server_that_is_not_there_yet():
    with UdpPeer() as unused:
        url = f"tcpout://127.0.0.1:{unused.port}"
    with pytest.raises(LinkError, match=r"endpoint server: .* connection refused"):
        async with routing(EndpointConfig("server", url)):
            pass
    async with routing(EndpointConfig("server", f"{url}?wait=yes&retry=10ms")) as router:
        await until(lambda: router.endpoints["server"].state == DOWN)
        assert "connection refused" in router.endpoints["server"].reason


@posix
async def test_serial_ports():
    pty = pytest.importorskip("pty")
    controller, device = pty.openpty()
    path = os.ttyname(device)
    os.set_blocking(controller, False)
    try:
        async with routing(EndpointConfig("serial", f"serial://{path}?retry=10ms"), VEHICLE) as router:
            with UdpPeer(port(router, "vehicle")) as vehicle:
                vehicle.send(heartbeat(2))
                received = bytearray()
                await until(
                    lambda: received.extend(read_some(controller)) or len(received) >= len(heartbeat())
                )
                assert bytes(received) == heartbeat(2)
                os.write(controller, heartbeat())
                assert await vehicle.receive() == heartbeat()
    finally:
        os.close(controller)
        os.close(device)


@pytest.mark.parametrize(
    ("options", "size"),
    [
        ("baud=57600", MIN_LINE_QUEUE),  # half a second is less than several packets
        ("baud=921600", 46_080),
        ("baud=921600&send_queue=3000", 3000),
        ("baud=12000000", 256 << 10),
    ],
)
def test_the_queue_of_a_serial_line_holds_half_a_second(options, size):
    assert queue_of_line(open_link(f"serial:///dev/ttyACM0?{options}")) == size


@posix
async def test_a_serial_port_that_was_unplugged_is_tried_again(tmp_path):
    pty = pytest.importorskip("pty")
    controller, device = pty.openpty()
    (path := tmp_path / "port").symlink_to(os.ttyname(device))
    os.close(device)
    async with routing(EndpointConfig("serial", f"serial://{path}?retry=10ms"), VEHICLE) as router:
        endpoint = router.endpoints["serial"]
        assert endpoint.state == OPEN
        path.unlink()
        os.close(controller)
        await until(lambda: endpoint.state == DOWN and str(path) in endpoint.reason)
        assert endpoint.reconnections == 1
        assert not endpoint.numbers


def read_some(descriptor):
    try:
        return os.read(descriptor, 4096)
    except BlockingIOError:
        return b""


async def test_udpout_sends_first():
    with UdpPeer() as ground:
        async with routing(VEHICLE, EndpointConfig("ground", f"udpout://127.0.0.1:{ground.port}")) as router:
            with UdpPeer(port(router, "vehicle")) as vehicle:
                vehicle.send(heartbeat())
                assert await ground.receive() == heartbeat()
                ground.send(heartbeat(255))
                assert await vehicle.receive() == heartbeat(255)
