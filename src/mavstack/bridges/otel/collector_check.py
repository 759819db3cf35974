"""Findings about a collector of OpenTelemetry: whether it takes spans and metrics by OTLP over HTTP."""

from __future__ import annotations

from typing import Final

from mavstack.bridges.core.finding import Finding
from mavstack.bridges.core.http_check import ask
from mavstack.bridges.otel.exporting import checked_url

#: The OTLP paths, by the kind of data that is sent to them.
_PATHS: Final = {"spans": "v1/traces", "metrics": "v1/metrics"}
_PROTOBUF: Final = "application/x-protobuf"
_OK: Final = 200
_NOT_FOUND: Final = 404
_UNAUTHORIZED: Final = (401, 403)


async def check_collector(url: str) -> list[Finding]:
    """Return the findings about a collector, which gets an empty request of each kind.

    Args:
        url: The collector, such as "http://127.0.0.1:4318".

    Raises:
        InvalidArgumentError: It is not such a URL.
        LinkError: Nothing answers there.
    """
    base = checked_url(url)
    answers = {kind: await ask(f"{base}/{path}", b"", _PROTOBUF) for kind, path in _PATHS.items()}
    return [_finding(base, kind, status) for kind, (status, _) in answers.items()]


def _finding(url: str, kind: str, status: int) -> Finding:
    if status == _OK:
        return Finding(True, f"the collector {url} takes {kind}")
    if status == _NOT_FOUND:
        reason = "it has no receiver of OTLP over HTTP there, or no pipeline for them"
    elif status in _UNAUTHORIZED:
        reason = "it wants a password or a key: set OTEL_EXPORTER_OTLP_HEADERS for the bridge"
    else:
        reason = f"it answers with the status {status}"
    return Finding(False, f"the collector {url} takes no {kind}: {reason}")
