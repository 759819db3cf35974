"""Findings about the metrics of a bridge to Prometheus: its vehicles, and whether a server reads them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.bridges.core.finding import Finding
from mavstack.bridges.core.http_check import ask
from mavstack.bridges.core.metrics import SCRAPES, VEHICLE
from mavstack.errors import MissingExtraError

if TYPE_CHECKING:
    from collections.abc import Iterator

_OK: Final = 200


async def check_metrics(url: str) -> list[Finding]:
    """Return the findings about the metrics at a URL.

    Raises:
        LinkError: Nothing answers there.
        MissingExtraError: The library is not installed.
    """
    status, body = await ask(url)
    if status != _OK:
        return [Finding(False, f"{url} answers with the status {status}: is it the bridge's port?")]
    return list(describe(url, body.decode("utf-8", "replace")))


def describe(url: str, text: str) -> Iterator[Finding]:
    """Yield the findings about the text of metrics.

    Args:
        url: The URL of the metrics.
        text: The metrics as Prometheus reads them.
    """
    try:
        from prometheus_client.parser import text_string_to_metric_families
    except ImportError:
        raise MissingExtraError("the bridge to Prometheus", "prometheus") from None
    try:
        samples = [sample for family in text_string_to_metric_families(text) for sample in family.samples]
    except ValueError as error:
        yield Finding(False, f"{url} does not send metrics of Prometheus: {error}")
        return
    scrapes = [sample.value for sample in samples if sample.name == f"{SCRAPES}_total"]
    if not scrapes:
        yield Finding(False, f"{url} is not a bridge of Mavstack")
        return
    yield Finding(True, f"{url} has {len(samples)} values")
    if scrapes[0]:
        yield Finding(True, f"the metrics were read {scrapes[0]:.0f} times before")
    else:
        yield Finding(
            False, "no server has read the metrics: name this address in scrape_configs of Prometheus"
        )
    up = {
        sample.labels.get("vehicle", ""): sample.value for sample in samples if sample.name == f"{VEHICLE}up"
    }
    if not up:
        yield Finding(False, "the bridge has found no vehicle: does its link receive heartbeats?")
    for name, value in sorted(up.items()):
        text = "sends heartbeats" if value else "is lost: no heartbeats of it arrive"
        yield Finding(bool(value), f"{name} {text}")
