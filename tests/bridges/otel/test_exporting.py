"""OTLP of a bridge as a process, decoded by opentelemetry-proto."""

from __future__ import annotations

import asyncio
import gzip
import signal
import subprocess
import sys
import threading
import time
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import TYPE_CHECKING, Any

import pytest

from mavstack.bridges.otel.exporting import checked_url, exported_spans
from mavstack.errors import InvalidArgumentError
from mavstack.sim.background import BackgroundSimulator
from mavstack.vehicle import connect
from tests.bridges.ros2.running import free_port

if TYPE_CHECKING:
    from collections.abc import Iterator


@contextmanager
def collector() -> Iterator[tuple[int, dict[str, list[bytes]]]]:
    """A receiver of OTLP over HTTP: its port, and the bodies by path."""
    bodies: dict[str, list[bytes]] = {}

    class Receiver(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            body = self.rfile.read(int(self.headers["Content-Length"]))
            if self.headers.get("Content-Encoding") == "gzip":
                body = gzip.decompress(body)
            bodies.setdefault(self.path, []).append(body)
            self.send_response(200)
            self.end_headers()

        def log_message(self, *arguments: Any) -> None:
            """Nothing."""

    with ThreadingHTTPServer(("127.0.0.1", 0), Receiver) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        try:
            yield server.server_port, bodies
        finally:
            server.shutdown()


@pytest.mark.parametrize("url", ["", "127.0.0.1:4318", "grpc://x:4317", "http://"])
def test_a_wrong_url(url: str) -> None:
    with pytest.raises(InvalidArgumentError, match="a collector must be http://HOST:4318"):
        checked_url(url)


def test_the_library_is_imported_only_when_it_is_used() -> None:
    code = (
        "import sys; from mavstack.cli.main import main; import mavstack.bridges.otel.exporting; "
        "import mavstack.bridges.otel.spans; import mavstack.bridges.otel.entry; "
        "from mavstack.cli.registry import command_parser; command_parser('bridge'); "
        "names = ('opentelemetry', 'paho', 'foxglove', 'prometheus_client', 'mcap'); "
        "print([name for name in names if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"


@pytest.mark.interop
@pytest.mark.smoke
def test_metrics_of_a_process_arrive_at_a_collector() -> None:
    pytest.importorskip("opentelemetry.exporter.otlp.proto.http")
    metrics = pytest.importorskip("opentelemetry.proto.collector.metrics.v1.metrics_service_pb2")
    with BackgroundSimulator() as simulator, collector() as (port, bodies):
        words = ["bridge", "otel", simulator.url, "--otlp", f"http://127.0.0.1:{port}", "--name", "1=alpha"]
        with subprocess.Popen(
            [sys.executable, "-m", "mavstack", *words], stdout=subprocess.PIPE, text=True
        ) as process:
            assert process.stdout is not None
            assert process.stdout.readline() == (
                f"OpenTelemetry http://127.0.0.1:{port}; read only; Ctrl-C to end\n"
            )
            end = time.monotonic() + 40
            while len(bodies.get("/v1/metrics", ())) < 2 and time.monotonic() < end:
                time.sleep(0.1)
            process.send_signal(signal.SIGTERM)
            assert process.wait(20) == 128 + signal.SIGTERM
    values: dict[str, float] = {}
    for body in bodies["/v1/metrics"]:
        request = metrics.ExportMetricsServiceRequest.FromString(body)
        for metric in request.resource_metrics[0].scope_metrics[0].metrics:
            for point in (*metric.gauge.data_points, *metric.sum.data_points):
                labels = {each.key: each.value.string_value for each in point.attributes}
                assert labels.get("vehicle", "alpha") == "alpha"
                values[metric.name] = point.as_double
    assert values["mavstack_vehicle_up"] == 1.0
    assert values["mavstack_link_received_packets"] > 10


@pytest.mark.interop
def test_spans_are_decoded_by_the_protocol_of_others() -> None:
    pytest.importorskip("opentelemetry.exporter.otlp.proto.http")
    traces = pytest.importorskip("opentelemetry.proto.collector.trace.v1.trace_service_pb2")

    async def fly(url: str, port: int) -> None:
        async with connect(url) as connection, exported_spans(f"http://127.0.0.1:{port}", connection):
            vehicle = await connection.wait_for_vehicle()
            await vehicle.set_mode("GUIDED")
            await vehicle.params.get("RTL_ALT")

    with BackgroundSimulator() as simulator, collector() as (port, bodies):
        asyncio.run(fly(simulator.url, port))
    requests = [traces.ExportTraceServiceRequest.FromString(body) for body in bodies["/v1/traces"]]
    assert len({span.span_id for span in spans_of(requests)}) == len(spans_of(requests)) >= 2
    for span in spans_of(requests):
        assert span.end_time_unix_nano >= span.start_time_unix_nano > 0
        assert {"mavlink.operation", "mavlink.attempts"} <= {each.key for each in span.attributes}
    assert any("RTL_ALT" in span.name for span in spans_of(requests))


def spans_of(requests: list[Any]) -> list[Any]:
    return [span for each in requests for span in each.resource_spans[0].scope_spans[0].spans]


@pytest.mark.interop
def test_a_collector_that_is_away_delays_neither_start_nor_end() -> None:
    pytest.importorskip("opentelemetry.exporter.otlp.proto.http")

    async def run() -> None:
        with BackgroundSimulator() as simulator:
            place = f"http://127.0.0.1:{free_port()}"
            async with connect(simulator.url) as connection, exported_spans(place, connection):
                vehicle = await connection.wait_for_vehicle()
                await vehicle.params.get("RTL_ALT")

    asyncio.run(asyncio.wait_for(run(), 30))
