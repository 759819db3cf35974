"""The metrics of a connection for Prometheus, read at each scrape by a server with its own threads.

A scrape asks the event loop for the values, vehicle by vehicle, with other work in between.
"""

from __future__ import annotations

import asyncio
import logging
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.bridge import DEFAULT_NAME
from mavstack.bridges.core.metrics import (
    MAX_VEHICLES,
    SCRAPES,
    Sample,
    correction_samples,
    link_samples,
    vehicle_samples,
)
from mavstack.errors import LinkError, MissingExtraError

try:
    from prometheus_client import CollectorRegistry, start_http_server
    from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily
    from prometheus_client.registry import Collector
except ImportError as error:
    raise MissingExtraError("the bridge to Prometheus", "prometheus") from error

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from types import TracebackType
    from typing import Self

    from prometheus_client.core import Metric

    from mavstack.vehicle import Connection

logger = logging.getLogger("mavstack.bridges")
#: Seconds to wait until the event loop returns the values of a scrape.
SCRAPE_TIMEOUT: Final = 8.0


class MetricsServer(Collector):
    """The server of the metrics; an async context manager.

    Args:
        connection: The open connection.
        host: The address to listen on.
        port: The port; 0: the system chooses.
        names: The names of vehicles by system id; others are "uav" and their system id.
    """

    def __init__(
        self, connection: Connection, host: str, port: int, names: Mapping[int, str] | None = None
    ) -> None:
        #: The number of scrapes that got no values.
        self.failed = 0
        self._scrapes = 0
        self._connection = connection
        self._host = host
        self._port = port
        self._names = dict(names or {})
        self._loop: asyncio.AbstractEventLoop | None = None
        self._server: Any = None
        self.registry = CollectorRegistry(auto_describe=False)
        self.registry.register(self)

    async def open(self) -> Self:
        """Listen.

        Returns:
            The server.

        Raises:
            LinkError: The port cannot be opened.
        """
        self._loop = asyncio.get_running_loop()
        try:
            self._server, _ = start_http_server(self._port, self._host, self.registry)
        except OSError as error:
            raise LinkError(
                f"opening the metrics on {self._host}:{self._port} failed: {error.strerror or error}; "
                "--port names another port"
            ) from None
        return self

    async def close(self) -> None:
        """Close the port. Idempotent."""
        loop, self._loop = self._loop, None
        server, self._server = self._server, None
        if server is not None and loop is not None:
            await loop.run_in_executor(None, server.shutdown)
            server.server_close()

    @property
    def port(self) -> int:
        """The port."""
        return int(self._server.server_port)

    def collect(self) -> Iterator[Metric]:
        """Yield all metrics; called in a thread of the server."""
        loop = self._loop
        if loop is None:
            return
        future = asyncio.run_coroutine_threadsafe(self._samples(), loop)
        try:
            samples = future.result(SCRAPE_TIMEOUT)
        except (TimeoutError, RuntimeError) as error:
            future.cancel()
            self.failed += 1
            logger.warning("a scrape got no values: %s", str(error) or "the program is busy")
            return
        text = "Readings of these metrics before this one"
        samples.append(Sample(SCRAPES, text, {}, float(self._scrapes), is_counter=True))
        self._scrapes += 1
        yield from families(samples)

    async def _samples(self) -> list[Sample]:
        found = [*link_samples(self._connection), *correction_samples(self._connection)]
        for vehicle in list(self._connection.vehicles.values())[:MAX_VEHICLES]:
            name = self._names.get(vehicle.system, f"{DEFAULT_NAME}{vehicle.system}")
            found += vehicle_samples(vehicle, name)
            await asyncio.sleep(0)
        return found

    async def __aenter__(self) -> Self:
        return await self.open()

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self.close()


def families(samples: list[Sample]) -> Iterator[Metric]:
    """Yield samples as families of Prometheus."""
    found: dict[str, Any] = {}
    for sample in samples:
        family = found.get(sample.name)
        if family is None:
            kind = CounterMetricFamily if sample.is_counter else GaugeMetricFamily
            family = found[sample.name] = kind(sample.name, sample.text, labels=list(sample.labels))
        family.add_metric(list(sample.labels.values()), sample.value)
    yield from found.values()
