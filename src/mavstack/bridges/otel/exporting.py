"""The export by OTLP over HTTP: spans and metrics, in threads of the library with bounded queues."""

from __future__ import annotations

import asyncio
import logging
from contextlib import asynccontextmanager
from importlib import import_module
from typing import TYPE_CHECKING, Any, Final
from urllib.parse import urlsplit

from mavstack.bridges.core.bridge import DEFAULT_NAME
from mavstack.bridges.core.metrics import (
    LINK,
    MAX_VEHICLES,
    METRICS,
    VEHICLE,
    Sample,
    correction_samples,
    link_samples,
    vehicle_samples,
)
from mavstack.bridges.otel.spans import OperationSpans
from mavstack.errors import InvalidArgumentError, MissingExtraError

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable, Iterator, Mapping

    from mavstack.vehicle import Connection

logger = logging.getLogger("mavstack.bridges")
#: Seconds in which the collector must take a batch.
EXPORT_TIMEOUT: Final = 3
#: Milliseconds between two exports of metrics, and seconds between two readings of the values.
_METRICS_INTERVAL: Final = 5000
_READ_INTERVAL: Final = 5.0
_NAME: Final = "mavstack"


@asynccontextmanager
async def exported_spans(url: str, connection: Connection) -> AsyncIterator[None]:
    """Export the operations of a connection while the context lasts.

    Args:
        url: The collector, such as "http://127.0.0.1:4318".
        connection: The open connection.

    Raises:
        InvalidArgumentError: It is not such a URL.
        MissingExtraError: The library is not installed.
    """
    place = f"{checked_url(url)}/v1/traces"
    trace = _library("opentelemetry.sdk.trace")
    export = _library("opentelemetry.sdk.trace.export")
    exporter = _library("opentelemetry.exporter.otlp.proto.http.trace_exporter")
    _quieten(url)
    provider = trace.TracerProvider(resource=_resource())
    sender = exporter.OTLPSpanExporter(endpoint=place, timeout=EXPORT_TIMEOUT)
    provider.add_span_processor(export.BatchSpanProcessor(sender))
    try:
        async with OperationSpans(connection, provider.get_tracer(_NAME)):
            yield
    finally:
        await _in_thread(provider.shutdown)


@asynccontextmanager
async def exported_metrics(
    url: str, connection: Connection, names: Mapping[int, str] | None = None
) -> AsyncIterator[None]:
    """Export the metrics of the vehicles of a connection while the context lasts.

    Args:
        url: The collector, such as "http://127.0.0.1:4318".
        connection: The open connection.
        names: The names of vehicles by system id; others are "uav" and their system id.

    Raises:
        InvalidArgumentError: It is not such a URL.
        MissingExtraError: The library is not installed.
    """
    place = f"{checked_url(url)}/v1/metrics"
    sdk = _library("opentelemetry.sdk.metrics")
    export = _library("opentelemetry.sdk.metrics.export")
    exporter = _library("opentelemetry.exporter.otlp.proto.http.metric_exporter")
    reader = export.PeriodicExportingMetricReader(
        exporter.OTLPMetricExporter(endpoint=place, timeout=EXPORT_TIMEOUT), _METRICS_INTERVAL
    )
    _quieten(url)
    readings = Readings(connection, names or {})
    await readings.read()
    provider = sdk.MeterProvider([reader], resource=_resource())
    readings.declare(provider.get_meter(_NAME))
    task = asyncio.get_running_loop().create_task(readings.follow())
    try:
        yield
    finally:
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)
        await _in_thread(provider.shutdown)


class Readings:
    """The last values of all metrics: read in the event loop, and observed in a thread of the library.

    Args:
        connection: The open connection.
        names: The names of vehicles by system id.
    """

    def __init__(self, connection: Connection, names: Mapping[int, str]) -> None:
        self._connection = connection
        self._names = names
        self._samples: dict[str, list[Sample]] = {}

    async def follow(self) -> None:
        """Read the values until the task is cancelled."""
        while True:
            await asyncio.sleep(_READ_INTERVAL)
            await self.read()

    async def read(self) -> None:
        """Read all values, vehicle by vehicle with other work in between."""
        found: dict[str, list[Sample]] = {}
        for sample in (*link_samples(self._connection), *correction_samples(self._connection)):
            found.setdefault(sample.name, []).append(sample)
        for vehicle in list(self._connection.vehicles.values())[:MAX_VEHICLES]:
            name = self._names.get(vehicle.system, f"{DEFAULT_NAME}{vehicle.system}")
            for sample in vehicle_samples(vehicle, name):
                found.setdefault(sample.name, []).append(sample)
            await asyncio.sleep(0)
        self._samples = found

    def declare(self, meter: Any) -> None:  # noqa: ANN401 (a class of the library)
        """Create the instruments."""
        texts = {f"{VEHICLE}{metric.name}": metric.text for metric in METRICS}
        texts |= {f"{VEHICLE}info": "Firmware and type", f"{VEHICLE}mode": "The present flight mode"}
        for name, text in texts.items():
            meter.create_observable_gauge(name, [self._observer(name)], description=text)
        counters = (f"{LINK}received_packets", f"{LINK}received_bytes", f"{LINK}bad_checksums")
        for name in (*counters, f"{VEHICLE}received_packets", f"{VEHICLE}lost_packets"):
            meter.create_observable_counter(name, [self._observer(name)])

    def _observer(self, name: str) -> Callable[[object], Iterator[Any]]:
        observation = _library("opentelemetry.metrics").Observation

        def observe(_options: object) -> Iterator[Any]:
            for sample in self._samples.get(name, ()):
                yield observation(sample.value, sample.labels)

        return observe


class _FirstProblem(logging.Handler):
    """Reports the first problem with the collector; the library logs each attempt."""

    def __init__(self, url: str) -> None:
        super().__init__(logging.WARNING)
        self._url = url
        self._level = logging.WARNING

    def emit(self, record: logging.LogRecord) -> None:
        """Log a record of the library."""
        text = f"the collector {self._url} takes nothing, is it running? Spans and values are dropped"
        logger.log(self._level, "%s", text)
        logger.debug("%s", record.getMessage())
        self._level = logging.DEBUG


def _quieten(url: str) -> None:
    """Replace the messages of the library by one line."""
    library = logging.getLogger("opentelemetry")
    if not any(isinstance(handler, _FirstProblem) for handler in library.handlers):
        library.addHandler(_FirstProblem(url))
        library.propagate = False


def checked_url(url: str) -> str:
    """Return the URL of a collector without a slash at its end.

    Raises:
        InvalidArgumentError: It is not a URL of HTTP.
    """
    try:
        parts = urlsplit(url)
        is_valid = parts.scheme in ("http", "https") and bool(parts.hostname) and parts.port != 0
    except ValueError:
        is_valid = False
    if not is_valid:
        raise InvalidArgumentError(f"a collector must be http://HOST:4318, got {url!r:.60}")
    return url.rstrip("/")


def _resource() -> Any:  # noqa: ANN401 (a class of the library)
    return _library("opentelemetry.sdk.resources").Resource.create({"service.name": _NAME})


async def _in_thread(function: Callable[[], object]) -> None:
    """Run a function that waits for the collector."""
    await asyncio.get_running_loop().run_in_executor(None, function)


def _library(name: str) -> Any:  # noqa: ANN401 (a module)
    try:
        return import_module(name)
    except ImportError:
        raise MissingExtraError("the export to OpenTelemetry", "otel") from None
