"""Findings about collectors by their answers."""

from __future__ import annotations

import asyncio
import threading
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import TYPE_CHECKING

import pytest

from mavstack.bridges.otel.collector_check import check_collector
from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.bridges.core.finding import Finding


@contextmanager
def collector(**statuses: int) -> Iterator[str]:
    """A server that answers on the paths of OTLP with these statuses."""

    class Handler(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            assert self.headers["Content-Type"] == "application/x-protobuf"
            self.send_response(statuses.get(self.path.rpartition("/")[2], 404))
            self.end_headers()

        def log_message(self, *arguments: object) -> None:
            pass

    with ThreadingHTTPServer(("127.0.0.1", 0), Handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}"
        server.shutdown()


def findings(**statuses: int) -> list[Finding]:
    with collector(**statuses) as url:
        return asyncio.run(check_collector(f"{url}/"))


def test_a_collector_that_takes_both() -> None:
    found = findings(traces=200, metrics=200)
    assert [(each.ok, each.text.partition(" takes ")[2]) for each in found] == [
        (True, "spans"),
        (True, "metrics"),
    ]


@pytest.mark.parametrize(
    ("status", "text"),
    [(404, "no receiver of OTLP"), (401, "OTEL_EXPORTER_OTLP_HEADERS"), (500, "the status 500")],
)
def test_a_collector_that_takes_no_spans(status: int, text: str) -> None:
    spans, metrics = findings(traces=status, metrics=200)
    assert (spans.ok, metrics.ok) == (False, True)
    assert " takes no spans: " in spans.text
    assert text in spans.text


@pytest.mark.parametrize("url", ["grpc://host", "http://", "http://[::1", "http://host:port"])
def test_a_wrong_url(url: str) -> None:
    with pytest.raises(InvalidArgumentError, match="a collector must be"):
        asyncio.run(check_collector(url))
