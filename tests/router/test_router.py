from __future__ import annotations

import asyncio
import socket
import time
from dataclasses import replace

import pytest

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError, InvalidStateError, LinkError, SigningError
from mavstack.router.config import EndpointConfig, PacketFilter, RouterConfig
from mavstack.router.engine import RouterEngine
from mavstack.router.router import Router
from mavstack.security import SigningKey
from mavstack.wire import Encoder
from tests.router.peers import UdpPeer, arm, heartbeat, names, port, routing, until

UDP = "udpin://127.0.0.1:0?trust_senders=yes"
VEHICLE, GROUND = EndpointConfig("vehicle", UDP), EndpointConfig("ground", UDP)


async def test_packets_pass_between_endpoints():
    async with routing(VEHICLE, GROUND) as router:
        with UdpPeer(port(router, "vehicle")) as vehicle, UdpPeer(port(router, "ground")) as ground:
            ground.send(heartbeat(255, 190))
            await until(lambda: router.statistics().routes)
            vehicle.send(heartbeat())
            assert await ground.receive() == heartbeat()
            ground.send(arm())
            assert names(await vehicle.receive()) == ["COMMAND_LONG"]
            routes = {(route.system, route.component) for route in router.statistics().routes}
            assert routes == {(1, 1), (255, 190)}


async def test_filters_groups_and_pauses_change_while_packets_flow():
    async with routing(VEHICLE, GROUND) as router:
        with UdpPeer(port(router, "vehicle")) as vehicle, UdpPeer(port(router, "ground")) as ground:
            ground.send(heartbeat(255, 190))
            await until(lambda: router.statistics().routes)
            before = router.endpoints["ground"]
            await router.change(replace(GROUND, outgoing=PacketFilter(deny_messages=frozenset({0}))))
            vehicle.send(heartbeat())
            await until(lambda: dropped(router, "ground").get("rule_out") == 1)
            await router.pause("ground")
            vehicle.send(heartbeat())
            await until(lambda: dropped(router, "ground").get("paused") == 1)
            await router.change(GROUND)
            vehicle.send(heartbeat(sequence=7))
            assert await ground.receive() == heartbeat(sequence=7)
            assert router.endpoints["ground"] is before
            assert router.config.endpoint("ground") == GROUND


def counted(router, name):
    (number,) = router.endpoints[name].numbers
    return router.statistics().endpoints[number]


def dropped(router, name):
    return counted(router, name).dropped


async def test_endpoints_are_added_and_removed():
    async with routing(VEHICLE) as router:
        await router.add(GROUND)
        assert port(router, "ground")
        with pytest.raises(InvalidArgumentError, match="already"):
            await router.add(GROUND)
        await router.remove("ground")
        assert [each.name for each in router.config.endpoints] == ["vehicle"]
        with pytest.raises(InvalidArgumentError, match="no endpoint ground; endpoints: vehicle"):
            await router.remove("ground")


async def test_a_port_in_use_is_an_error_with_the_name_of_the_endpoint():
    with UdpPeer() as other:
        taken = EndpointConfig("ground", f"udpin://127.0.0.1:{other.port}")
        router = Router(RouterConfig((VEHICLE, taken)))
        with pytest.raises(LinkError, match=r"endpoint ground: cannot open udpin://.*: port \d+ is in use"):
            await router.open()
        assert not router.is_open
        with pytest.raises(InvalidStateError, match="not open"):
            router.statistics()


async def test_apply_tries_again_what_could_not_be_opened(monkeypatch):
    monkeypatch.setattr("mavstack.router.router.RETRY_INTERVAL", 0.01)
    other = UdpPeer()
    taken = EndpointConfig("ground", f"udpin://127.0.0.1:{other.port}")
    async with routing(VEHICLE) as router:
        (note,) = await router.apply(RouterConfig((VEHICLE, taken)))
        assert "is in use" in note
        assert router.problems["ground"] == note
        other.socket.close()
        await until(lambda: "ground" in router.endpoints)
        assert router.problems == {}


async def test_apply_opens_again_only_what_changed():
    async with routing(VEHICLE, GROUND) as router:
        vehicle, ground = router.endpoints["vehicle"], router.endpoints["ground"]
        changed = RouterConfig((VEHICLE, replace(GROUND, url="udpin://127.0.0.1:0?idle=5")), dialect="common")
        notes = await router.apply(changed)
        assert router.endpoints["vehicle"] is vehicle
        assert router.endpoints["ground"] is not ground
        assert notes == ("dialect changes when the router is started again",)
        assert await router.apply(changed) == notes  # until it was started again


async def test_a_reload_takes_the_new_key_of_a_name(tmp_path):
    path = tmp_path / "field.key"
    signed = replace(VEHICLE, url=f"{VEHICLE.url}&signing_key={path}")
    keys = [SigningKey.from_passphrase(word) for word in ("old", "new")]

    async def passes(vehicle, key):
        encoder = Encoder(1, 1, signing=key.signing())
        before = counted(router, "vehicle").received, counted(router, "ground").sent
        vehicle.send(encoder.encode(common.Heartbeat(type=2, autopilot=12), time.time()))
        await until(lambda: counted(router, "vehicle").received > before[0])
        return counted(router, "ground").sent > before[1]

    keys[0].save(path)
    async with routing(signed, GROUND) as router:
        with UdpPeer(port(router, "vehicle")) as vehicle, UdpPeer(port(router, "ground")) as ground:
            ground.send(heartbeat(255, 190))
            await until(lambda: router.statistics().routes)
            assert [await passes(vehicle, key) for key in keys] == [True, False]
            path.write_text(keys[1].secret_bytes().hex())
            await router.apply(router.config)
            assert [await passes(vehicle, key) for key in keys] == [False, True]
            path.unlink()
            with pytest.raises(SigningError, match="field"):
                await router.apply(router.config)


@pytest.mark.parametrize("times", [20, pytest.param(1000, marks=pytest.mark.nightly)])
async def test_reloads_lose_nothing_on_unchanged_links(times):
    """Traffic flows while other endpoints are added, removed, and changed."""
    total = 0
    async with routing(VEHICLE, GROUND) as router:
        with UdpPeer(port(router, "vehicle")) as vehicle, UdpPeer(port(router, "ground")) as ground:
            ground.send(heartbeat(255, 190))
            await until(lambda: router.statistics().routes)
            for turn in range(times):
                third = EndpointConfig("third", f"{UDP}&idle={5 + turn % 2}", group="x" if turn % 3 else "")
                changed = replace(GROUND, rates=((30, 1.0 + turn),))
                sending = asyncio.create_task(send_some(vehicle, turn))
                await router.apply(RouterConfig((VEHICLE, changed, *((third,) if turn % 4 else ()))))
                await sending
                for step in range(20):
                    assert await ground.receive() == heartbeat(sequence=(turn * 20 + step) % 256)
                    total += 1
        assert total == times * 20


async def send_some(peer, turn):
    for step in range(20):
        peer.send(heartbeat(sequence=(turn * 20 + step) % 256))
        await asyncio.sleep(0)


async def test_listen_only_endpoints_get_packets_but_send_none():
    async with routing(VEHICLE, replace(GROUND, listen_only=True)) as router:
        with UdpPeer(port(router, "vehicle")) as vehicle, UdpPeer(port(router, "ground")) as ground:
            vehicle.send(heartbeat())
            ground.send(heartbeat(255, 190))
            await until(lambda: dropped(router, "ground").get("listen_only") == 1)
            assert vehicle.waiting() == 0


async def test_closing_is_idempotent():
    router = Router(RouterConfig((VEHICLE,)))
    async with router:
        pass
    await router.close()
    await asyncio.wait_for(router.serve_forever(), 1)


async def test_an_engine_that_ended_by_itself_ends_the_router(monkeypatch):
    async with routing(VEHICLE, GROUND) as router:
        monkeypatch.setattr(RouterEngine, "events", lambda engine: [("ended",)])
        with UdpPeer(port(router, "vehicle")) as vehicle:
            vehicle.send(heartbeat())  # the engine has an event: a new peer
        with pytest.raises(InvalidStateError, match="engine ended"):
            await asyncio.wait_for(router.serve_forever(), 5)


class WithoutReaders(asyncio.SelectorEventLoop):
    """An event loop without socket readers, like the proactor of Windows."""

    def add_reader(self, fd, callback, *args):  # type: ignore[override]
        raise NotImplementedError

    def remove_reader(self, fd):
        raise NotImplementedError


def test_an_event_loop_without_socket_readers():
    """Packets pass, an endpoint that Python carries gets those for it, and a server accepts clients."""
    carried = replace(GROUND, url=f"{UDP}&latency=0")
    server = EndpointConfig("server", "tcpin://127.0.0.1:0")

    async def exchange():
        async with routing(VEHICLE, carried, server) as router:
            await asyncio.sleep(0.01)  # the server waits for clients
            with socket.create_connection(("127.0.0.1", port(router, "server"))):
                await until(lambda: router.endpoints["server"].numbers)
            vehicle = UdpPeer(port(router, "vehicle"))
            ground = UdpPeer(port(router, "ground"))
            ground.send(heartbeat(255, 190))
            await until(lambda: router.statistics().routes)
            vehicle.send(heartbeat())
            await until(ground.waiting)
            vehicle.socket.close()
            ground.socket.close()

    with asyncio.Runner(loop_factory=WithoutReaders) as runner:
        runner.run(exchange())
