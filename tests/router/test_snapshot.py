from __future__ import annotations

import json

from mavstack import encode
from mavstack.dialects import common
from mavstack.router.config import EndpointConfig, PacketFilter, RouterConfig, parse_config
from mavstack.router.snapshot import endpoint_values, take_snapshot
from mavstack.security import SigningKey
from tests.router.peers import UdpPeer, heartbeat, port, routing, until

GROUND = EndpointConfig("ground", "udpin://127.0.0.1:0", group="radio")
QUIET = EndpointConfig(
    "quiet", "udpin://127.0.0.1:0", listen_only=True, outgoing=PacketFilter(deny_messages=frozenset({0}))
)


async def test_counters_rules_sources_and_routes():
    async with routing(GROUND, QUIET) as router:
        with UdpPeer(port(router, "ground")) as ground, UdpPeer(port(router, "quiet")) as quiet:
            quiet.send(heartbeat(9))
            await until(lambda: take_snapshot(router).endpoints[1].dropped.get("listen_only"))
            ground.send(heartbeat(sequence=1) + b"junk" + heartbeat(sequence=3))
            await until(lambda: take_snapshot(router).endpoints[0].received == 2)
            first, second = take_snapshot(router).endpoints
    assert (first.name, first.state, first.group) == ("ground", "open", "radio")
    assert first.links == [f"ground 127.0.0.1:{ground_port(first)}"]
    assert (first.messages, first.sources, first.lost, first.bad_bytes) == (
        {"HEARTBEAT": (2, 0)},
        {"1/1": (2, 1)},
        1,
        4,
    )
    assert second.listen_only
    assert second.address.startswith("127.0.0.1:")
    assert json.loads(json.dumps(endpoint_values(first)))["dropped"] == {}


def ground_port(state):
    return state.links[0].rpartition(":")[2]


async def test_rules_are_counted_by_name():
    async with routing(GROUND, EndpointConfig("quiet", QUIET.url, outgoing=QUIET.outgoing)) as router:
        with UdpPeer(port(router, "ground")) as ground, UdpPeer(port(router, "quiet")) as quiet:
            quiet.send(heartbeat(9))
            await until(lambda: router.statistics().routes)
            ground.send(heartbeat())
            await until(lambda: take_snapshot(router).endpoints[1].rules)
            assert take_snapshot(router).endpoints[1].rules == {"out.deny_messages": 1}
            assert [route.system for route in take_snapshot(router).routes] == [1, 9]


async def test_endpoints_that_could_not_be_opened_are_shown(tmp_path):
    SigningKey.generate().save(tmp_path / "secret.key")
    with UdpPeer() as other:
        taken = EndpointConfig("taken", f"udpin://127.0.0.1:{other.port}?signing_key={tmp_path}/secret.key")
        async with routing(GROUND) as router:
            await router.apply(RouterConfig((GROUND, taken)))
            failed = take_snapshot(router).endpoints[1]
            assert failed.state == "failed"
            assert "is in use" in failed.reason


FIREWALL = parse_config("[firewall]\ndetectors = ['injected-positions']\ndefault = 'allow'\n").firewall


async def test_the_newest_alerts_are_shown_and_reported():
    reported = []
    async with routing(GROUND, firewall=FIREWALL) as router:
        router.add_alert_observer(reported.append)
        with UdpPeer(port(router, "ground")) as ground:
            ground.send(encode(common.HilGps(), system=255, component=190))
            await until(lambda: reported)
        ((age, text),) = take_snapshot(router).alerts
    assert reported[0].detector == "injected-positions"
    assert 0 <= age < 60
    assert text.startswith("injected-positions: radio 255/190: HIL_GPS from a sender")
