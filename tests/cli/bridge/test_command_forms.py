"""The command forms of `mav bridge` as processes: one line when they are ready, and a clean end."""

from __future__ import annotations

import signal
import subprocess
import sys
from contextlib import ExitStack
from typing import TYPE_CHECKING

import pytest

from mavstack.sim.background import BackgroundSimulator
from tests.bridges.mqtt.test_broker import MOSQUITTO, broker
from tests.bridges.ros2.running import free_port, zenoh_router

if TYPE_CHECKING:
    from pathlib import Path

#: The words after the URL, the module that they need, and the line.
FORMS = {
    "ros2 --connect tcp/127.0.0.1:{zenoh}": (
        "zenoh",
        "ROS 2 domain 0 over Zenoh by tcp/127.0.0.1:{zenoh}; read only; Ctrl-C to end",
    ),
    "ros2 --via zenoh --connect tcp/127.0.0.1:{zenoh} --domain 7 --namespace alpha --allow-control": (
        "zenoh",
        "ROS 2 domain 7 over Zenoh by tcp/127.0.0.1:{zenoh}; control allowed; Ctrl-C to end",
    ),
    "ros2 --via dds --domain 88": (
        "cyclonedds",
        "ROS 2 domain 88 over DDS: topics only, no services and actions; read only; Ctrl-C to end",
    ),
    "zenoh --connect tcp/127.0.0.1:{zenoh}": (
        "zenoh",
        "fleet mavstack on Zenoh by tcp/127.0.0.1:{zenoh}; read only; Ctrl-C to end",
    ),
    "foxglove --port {port}": ("foxglove", "Foxglove ws://127.0.0.1:{port}; read only; Ctrl-C to end"),
    "mqtt --broker mqtt://127.0.0.1:{mqtt}": (
        "paho.mqtt",
        "MQTT mqtt://127.0.0.1:{mqtt}, topics below mavstack/; read only; Ctrl-C to end",
    ),
    "prometheus --port {port}": ("", "Prometheus http://127.0.0.1:{port}/metrics; read only; Ctrl-C to end"),
}


@pytest.mark.interop
@pytest.mark.parametrize("end", ["SIGINT", "SIGTERM"])
@pytest.mark.parametrize("form", FORMS)
def test_a_bridge_is_ready_and_ends(form: str, end: str, tmp_path: Path) -> None:
    module, ready = FORMS[form]
    if module:
        pytest.importorskip(module)
    places = {"port": free_port()}
    with ExitStack() as stack:
        if "{zenoh}" in form:
            places["zenoh"] = stack.enter_context(zenoh_router())
        if "{mqtt}" in form:
            if not MOSQUITTO:
                pytest.skip("mosquitto is not installed")
            places["mqtt"] = stack.enter_context(broker(tmp_path))
        simulator = stack.enter_context(BackgroundSimulator())
        bus, *words = form.format(**places).split()
        command = [sys.executable, "-m", "mavstack", "bridge", bus, simulator.url, *words]
        process = stack.enter_context(
            subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        )
        stack.callback(process.kill)
        assert process.stdout is not None
        assert process.stdout.readline() == ready.format(**places) + "\n"
        number = signal.Signals[end]
        process.send_signal(number)
        rest, problems = process.communicate(timeout=20)
        assert (rest, problems, process.returncode) == ("", "", 128 + number)
