"""`mav msp bridge` with a fake flight controller, in virtual time."""

from __future__ import annotations

import asyncio
import json

import pytest

from mavstack.bridges.msp.bridge import MspBridge
from mavstack.cli.main import main
from mavstack.cli.msp import bridging
from mavstack.sim.virtual import run_virtually
from tests.bridges.msp.fake_controller import FakeController

URL = "msp+tcp://127.0.0.1:9"


@pytest.fixture
def bridged(monkeypatch):
    """Let the command open a fake controller, and end by itself; yields the bridges that it made."""
    bridges = []

    class Bridge(MspBridge):
        async def serve_forever(self) -> None:
            bridges.append(self)
            await asyncio.sleep(1)

    def run(arguments, work):
        return run_virtually(work(FakeController()))

    monkeypatch.setattr(bridging, "MspBridge", Bridge)
    monkeypatch.setattr(bridging, "run_on_controller", run)
    return bridges


def test_the_vehicle_and_its_links_are_announced(bridged, capsys):
    assert (
        main(["msp", "bridge", URL, "udpout://127.0.0.1:14559", "udpin://127.0.0.1:0", "--system", "9"]) == 0
    )
    out = capsys.readouterr().out
    assert out.startswith("Betaflight 4.5.1 is vehicle 9/1 on udpout://127.0.0.1:14559, udpin://127.0.0.1:")
    assert bridged[0].node.address == (9, 1)
    assert not bridged[0].node.is_open


def test_json(bridged, capsys):
    assert main(["msp", "bridge", URL, "udpout://127.0.0.1:14559", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {
        "firmware": "BTFL",
        "system": 1,
        "component": 1,
        "links": ["udpout://127.0.0.1:14559"],
    }


@pytest.mark.parametrize("arguments", [[URL], [URL, "udpout://127.0.0.1:14559", "--system", "300"]])
def test_wrong_usage(bridged, arguments, capsys):
    with pytest.raises(SystemExit) as ended:
        raise SystemExit(main(["msp", "bridge", *arguments]))
    assert ended.value.code == 2
    assert capsys.readouterr().err


def test_a_wrong_link_is_reported_in_one_line(bridged, capsys):
    assert main(["msp", "bridge", URL, "udpx://127.0.0.1:1"]) == 2
    assert "unknown scheme 'udpx'" in capsys.readouterr().err
