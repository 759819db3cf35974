"""The live picture of a router: a line for each endpoint with its rates, then the learned routes."""

from __future__ import annotations

from dataclasses import dataclass
from time import monotonic
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.live_display import LiveDisplay, Text
from mavstack.cli.common.text import duration_text, printable, size_text
from mavstack.router.snapshot import take_snapshot

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from mavstack.router.router import Router
    from mavstack.router.snapshot import EndpointState, RouteState, Snapshot

#: Seconds over which rates are computed.
RATE_INTERVAL: Final = 1.0
_STYLES: Final = {
    "open": "green",
    "listening": "cyan",
    "down": "bold red",
    "failed": "bold red",
    "ended": "red",
}
_NAME_WIDTH: Final = 20
#: Maximum number of alerts that are shown.
MAX_ALERTS: Final = 3
#: Seconds without a packet after which a route is shown in grey.
_STALE: Final = 5.0


@dataclass(frozen=True, slots=True)
class Rates:
    """Packets and bytes per second of one endpoint."""

    received: float = 0.0
    received_bytes: float = 0.0
    sent: float = 0.0
    sent_bytes: float = 0.0
    dropped: float = 0.0


@dataclass(frozen=True, slots=True)
class Picture:
    """A snapshot with the rates of each endpoint, and the seconds since the start."""

    snapshot: Snapshot
    rates: Mapping[str, Rates]
    seconds: float


class RateMeter:
    """Computes the rates between two snapshots at least `RATE_INTERVAL` apart."""

    def __init__(self) -> None:
        self._counts: dict[str, tuple[int, ...]] = {}
        self._time = 0.0
        self._rates: dict[str, Rates] = {}

    def update(self, snapshot: Snapshot, now: float) -> Mapping[str, Rates]:
        """Return the rates of the last interval.

        Args:
            snapshot: The present state.
            now: Time in seconds.
        """
        elapsed = now - self._time
        if elapsed >= RATE_INTERVAL:
            counts = {each.name: _counts(each) for each in snapshot.endpoints}
            before = self._counts
            self._rates = {
                name: Rates(
                    *(max(new - old, 0) / elapsed for new, old in zip(each, before[name], strict=True))
                )
                for name, each in counts.items()
                if name in before
            }
            self._counts, self._time = counts, now
        return self._rates


class RouterDisplay(LiveDisplay[Picture]):
    """The live picture of one router."""

    def __init__(self, router: Router) -> None:
        super().__init__()
        self._router = router
        self._meter = RateMeter()
        self._started = monotonic()
        self._last: Picture | None = None

    def snapshot(self) -> Picture:
        """Return the present state; after the end of the router, the last one."""
        now = monotonic()
        if self._router.is_open or self._last is None:
            snapshot = take_snapshot(self._router)
            self._last = Picture(snapshot, self._meter.update(snapshot, now), now - self._started)
        return self._last

    def lines(self, snapshot: Picture, width: int, height: int) -> list[Text]:
        """Return the lines of a picture."""
        return render(snapshot, width, height)


def render(picture: Picture, width: int, height: int) -> list[Text]:
    """Render a picture in at most `height` lines of at most `width` columns."""
    endpoints, routes = picture.snapshot.endpoints, picture.snapshot.routes
    lines = [_title(picture, width), _head()]
    alerts = list(_alerts(picture.snapshot.alerts))
    available = max(height - len(lines) - min(len(routes), height // 3) - len(alerts) - 3, 1)
    shown = endpoints[: max(available // 2, 1)]  # each endpoint takes two lines
    for endpoint in shown:
        lines += _endpoint(endpoint, picture.rates.get(endpoint.name, Rates()))
    if len(endpoints) > len(shown):
        lines.append(Text(f" … {len(endpoints) - len(shown)} more endpoints", style="dim"))
    has_received = any(endpoint.received for endpoint in endpoints)
    lines += [Text(), *alerts, *_routes(routes, max(height - len(lines) - len(alerts) - 3, 1), has_received)]
    lines.append(Text(" Ctrl-C ends the router", style="dim"))
    for line in lines:
        line.no_wrap = True
        line.truncate(width, overflow="ellipsis")
    return lines[:height]


def _title(picture: Picture, width: int) -> Text:
    clock = duration_text(picture.seconds)
    title = Text(" mav route", style="bold reverse")
    title.append(" " * max(width - title.cell_len - len(clock) - 1, 1) + clock + " ")
    return title


def _head() -> Text:
    return Text(
        f" {'endpoint':{_NAME_WIDTH}} {'state':9} {'in/s':>8} {'':>9} {'out/s':>8} {'':>9} "
        f"{'drop/s':>7} {'lost':>6}",
        style="bold",
    )


def _endpoint(endpoint: EndpointState, rates: Rates) -> Iterator[Text]:
    state = "paused" if endpoint.pause and endpoint.state == "open" else endpoint.state
    line = Text(f" {endpoint.name[:_NAME_WIDTH]:{_NAME_WIDTH}} ")
    line.append(f"{state:9} ", _STYLES.get(state, "yellow"))
    line.append(f"{rates.received:8.0f} {size_text(rates.received_bytes) + '/s':>9} ")
    line.append(f"{rates.sent:8.0f} {size_text(rates.sent_bytes) + '/s':>9} ")
    line.append(f"{rates.dropped:7.0f} ", "yellow" if rates.dropped >= 0.5 else "")
    line.append(f"{endpoint.lost:6}", "yellow" if endpoint.lost else "")
    yield line
    detail = endpoint.reason or endpoint.url
    if len(endpoint.links) > 1:
        detail += f", {len(endpoint.links)} links"
    if endpoint.group:
        detail += f", group {endpoint.group}"
    yield Text(f"   {detail}", style="dim")


def _alerts(alerts: Sequence[tuple[float, str]]) -> Iterator[Text]:
    """Yield the lines of the newest alerts of the firewall, newest first."""
    if alerts:
        yield Text(" alerts of the firewall", style="bold")
    for age, text in [*reversed(alerts)][:MAX_ALERTS]:
        yield Text(f"   {duration_text(age):>6} ago  {printable(text)}", style="yellow")


def _routes(routes: Sequence[RouteState], maximum: int, has_received: bool) -> Iterator[Text]:
    if not routes:
        yield Text(f" {'no address is known now' if has_received else 'no packet received yet'}", style="dim")
        return
    yield Text(" addresses", style="bold")
    shown = routes if len(routes) <= maximum else routes[: max(maximum - 1, 1)]
    for route in shown:
        address = f"{route.system}/{route.component}"
        line = Text(f"   {address:9}{', '.join(route.endpoints)}", style="dim" if route.age > _STALE else "")
        line.append(f"  {duration_text(route.age)} ago" if route.age > _STALE else "")
        yield line
    if len(routes) > len(shown):
        yield Text(f"   … {len(routes) - len(shown)} more", style="dim")


def _counts(endpoint: EndpointState) -> tuple[int, ...]:
    return (
        endpoint.received,
        endpoint.received_bytes,
        endpoint.sent,
        endpoint.sent_bytes,
        sum(endpoint.dropped.values()),
    )
