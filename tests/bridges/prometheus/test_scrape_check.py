"""Findings about metrics: of a bridge, and of others."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.errors import LinkError
from mavstack.sim.background import BackgroundSimulator
from mavstack.vehicle import connect
from tests.bridges.ros2.running import free_port

pytest.importorskip("prometheus_client")
from mavstack.bridges.prometheus.exporter import MetricsServer
from mavstack.bridges.prometheus.scrape_check import check_metrics, describe

METRICS = """\
mavstack_scrapes_total {scrapes}
mavstack_vehicle_up{{vehicle="alpha",system_id="1"}} 1.0
mavstack_vehicle_up{{vehicle="beta",system_id="2"}} 0.0
"""


def texts(text: str) -> list[tuple[bool, str]]:
    return [(each.ok, each.text) for each in describe("http://h/metrics", text)]


def test_vehicles_and_scrapes() -> None:
    assert texts(METRICS.format(scrapes="7.0")) == [
        (True, "http://h/metrics has 3 values"),
        (True, "the metrics were read 7 times before"),
        (True, "alpha sends heartbeats"),
        (False, "beta is lost: no heartbeats of it arrive"),
    ]


def test_no_server_reads_them() -> None:
    found = texts("mavstack_scrapes_total 0.0\n")
    assert [ok for ok, _ in found] == [True, False, False]
    assert found[1][1].startswith("no server has read the metrics")
    assert found[2][1].startswith("the bridge has found no vehicle")


def test_a_vehicle_without_a_name() -> None:
    found = texts("mavstack_scrapes_total 1.0\nmavstack_vehicle_up 1.0\n")
    assert found[-1] == (True, " sends heartbeats")


def test_others() -> None:
    assert texts("python_info 1.0\n") == [(False, "http://h/metrics is not a bridge of Mavstack")]
    ((ok, text),) = texts("<html>no metrics</html>\n")
    assert not ok
    assert text.startswith("http://h/metrics does not send metrics of Prometheus")


def test_a_running_bridge_and_none() -> None:
    async def scenario(url: str) -> None:
        async with connect(url) as connection, MetricsServer(connection, "127.0.0.1", 0) as server:
            await connection.wait_for_vehicle()
            place = f"http://127.0.0.1:{server.port}"
            first, again = [await check_metrics(f"{place}/metrics") for _ in range(2)]
            assert [each.ok for each in first] == [True, False, True]
            assert again[1].text == "the metrics were read 1 times before"
        with pytest.raises(LinkError, match=r"asking http://127\.0\.0\.1:\d+/metrics failed"):
            await check_metrics(f"http://127.0.0.1:{free_port()}/metrics")

    with BackgroundSimulator() as simulator:
        asyncio.run(scenario(simulator.url))
