"""Metrics of simulated vehicles: read at a scrape, accepted by promtool, scraped by the real server."""

from __future__ import annotations

import asyncio
import json
import shutil
import signal
import subprocess
import sys
import time
import urllib.request
from contextlib import suppress
from typing import TYPE_CHECKING

import pytest

from mavstack.bridges.core.metrics import correction_samples, link_samples, vehicle_samples
from mavstack.errors import LinkError
from mavstack.sim.background import BackgroundSimulator
from mavstack.sim.vehicle_types import VehicleType
from tests.bridges.ros2.running import free_port
from tests.gnss.test_rtcm import station
from tests.vehicle.world import ARDUPILOT, PX4, World, fly

if TYPE_CHECKING:
    from pathlib import Path
    from typing import Any

    from mavstack.vehicle import Vehicle

pytest.importorskip("prometheus_client")
from prometheus_client.parser import text_string_to_metric_families

from mavstack.bridges.prometheus.exporter import MetricsServer

PROMETHEUS, PROMTOOL = shutil.which("prometheus"), shutil.which("promtool")
VEHICLES = [(VehicleType.COPTER, ARDUPILOT), (VehicleType.COPTER, PX4)]


def get(url: str) -> str:
    with urllib.request.urlopen(url, timeout=10) as answer:
        text: str = answer.read().decode()
        return text


def test_values_of_vehicles_and_links() -> None:
    async def scenario(world: World, vehicle: Vehicle) -> None:
        await world.node.wait_for_vehicles(2)
        await vehicle.get_position()
        await asyncio.sleep(3)
        found = {sample.name: sample for sample in vehicle_samples(vehicle, "alpha")}
        assert found["mavstack_vehicle_up"].value == 1.0
        assert found["mavstack_vehicle_armed"].value == 0.0
        assert 0.9 < found["mavstack_vehicle_battery_remaining_ratio"].value <= 1.0
        assert found["mavstack_vehicle_latitude_degrees"].value == pytest.approx(47.4, abs=0.1)
        assert found["mavstack_vehicle_mode"].labels == {
            "vehicle": "alpha",
            "system_id": "1",
            "mode": "STABILIZE",
        }
        assert found["mavstack_vehicle_info"].labels["autopilot"] == "ARDUPILOTMEGA"
        links = [(each.name, each.labels, each.value) for each in link_samples(world.node)]
        received = {name: value for name, labels, value in links if labels.get("system_id") == "2"}
        assert received["mavstack_vehicle_received_packets"] > 50
        assert received["mavstack_vehicle_lost_packets"] == 0
        assert next(value for name, _, value in links if name == "mavstack_link_received_packets") > 100

    fly(VEHICLES, scenario)


def test_lost_packets_are_counted() -> None:
    async def scenario(world: World, vehicle: Vehicle) -> None:
        await asyncio.sleep(20)
        lost = [each.value for each in link_samples(world.node) if each.name.endswith("lost_packets")]
        assert lost[0] > 0

    fly(VEHICLES[0], scenario, loss=0.2)


def test_corrections_are_counted() -> None:
    async def scenario(world: World, vehicle: Vehicle) -> None:
        vehicle.rtk.send(station().data)
        found = {each.name: each for each in correction_samples(world.node)}
        assert found["mavstack_corrections_frames"].value == 1
        assert found["mavstack_corrections_data"].value == len(station().data)
        assert all(each.is_counter for each in found.values())

    fly(VEHICLES[0], scenario)


def test_a_port_in_use_is_an_error_with_a_remedy() -> None:
    async def open_twice() -> None:
        connection: Any = None
        async with MetricsServer(connection, "127.0.0.1", 0) as first:
            with pytest.raises(LinkError, match="--port names another port"):
                await MetricsServer(connection, "127.0.0.1", first.port).open()

    asyncio.run(open_twice())


def test_a_scrape_without_an_event_loop_is_empty() -> None:
    connection: Any = None
    assert list(MetricsServer(connection, "127.0.0.1", 0).collect()) == []


@pytest.mark.interop
@pytest.mark.smoke
@pytest.mark.skipif(PROMETHEUS is None, reason="prometheus is not installed")
def test_the_real_server_scrapes_a_bridge(tmp_path: Path) -> None:
    port, place = free_port(), free_port()
    config = {
        "global": {"scrape_interval": "1s", "evaluation_interval": "1s"},
        "rule_files": [str(tmp_path / "alerts.yml")],
        "scrape_configs": [{"job_name": "mavstack", "static_configs": [{"targets": [f"127.0.0.1:{port}"]}]}],
    }
    (tmp_path / "prometheus.yml").write_text(json.dumps(config))
    words = ["--port", str(port), "--name", "1=alpha", "--alerts", str(tmp_path / "alerts.yml")]
    with BackgroundSimulator() as simulator:
        command = [sys.executable, "-m", "mavstack", "bridge", "prometheus", simulator.url, *words]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as bridge:
            assert bridge.stdout is not None
            assert bridge.stdout.readline() == (
                f"Prometheus http://127.0.0.1:{port}/metrics; read only; Ctrl-C to end\n"
            )
            server = [
                str(PROMETHEUS),
                f"--config.file={tmp_path / 'prometheus.yml'}",
                f"--storage.tsdb.path={tmp_path / 'data'}",
                f"--web.listen-address=127.0.0.1:{place}",
            ]
            with subprocess.Popen(server, stderr=subprocess.DEVNULL) as prometheus:
                try:
                    result = queried(place, "mavstack_vehicle_battery_voltage_volts")
                    assert result["metric"]["vehicle"] == "alpha"
                    assert 10 < float(result["value"][1]) < 20
                    rules = json.loads(get(f"http://127.0.0.1:{place}/api/v1/rules"))
                    states = [rule["health"] for rule in rules["data"]["groups"][0]["rules"]]
                    assert "err" not in states
                finally:
                    prometheus.terminate()
            check_by_promtool(get(f"http://127.0.0.1:{port}/metrics"))
            bridge.send_signal(signal.SIGTERM)
            assert bridge.wait(20) == 128 + signal.SIGTERM


def queried(port: int, expression: str) -> dict[str, Any]:
    """The first result of a query, when there is one."""
    end = time.monotonic() + 40
    while time.monotonic() < end:
        with suppress(OSError):
            found = json.loads(get(f"http://127.0.0.1:{port}/api/v1/query?query={expression}"))
            if found["data"]["result"]:
                first: dict[str, Any] = found["data"]["result"][0]
                return first
        time.sleep(0.2)
    raise AssertionError("Prometheus has no such metric")


def check_by_promtool(text: str) -> None:
    assert len(list(text_string_to_metric_families(text))) > 20
    if PROMTOOL is not None:
        done = subprocess.run(
            [PROMTOOL, "check", "metrics"], input=text, capture_output=True, text=True, check=False
        )
        assert (done.returncode, done.stderr) == (0, ""), done.stdout + done.stderr
