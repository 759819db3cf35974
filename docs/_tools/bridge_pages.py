"""The mapping table of the bridges by kind of row, the differences to MAVROS, metrics, commands of MQTT."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.bridges.core.metrics import METRICS
from mavstack.bridges.core.row import Publication, Service, Subscription
from mavstack.bridges.core.table import ACTIONS, PUBLICATIONS, SERVICES, SUBSCRIPTIONS
from mavstack.bridges.mqtt.vehicle_topics import TOPICS
from mavstack.bridges.mqtt.verbs import VERBS
from mavstack.services.message_request.interval import name_of

if TYPE_CHECKING:
    from collections.abc import Iterable

    from mavstack.bridges.core.row import Row

_SECTIONS: Final[tuple[tuple[str, tuple[Row, ...]], ...]] = (
    ("Topics from the vehicle", PUBLICATIONS),
    ("Topics to the vehicle", SUBSCRIPTIONS),
    ("Services", SERVICES),
    ("Actions", ACTIONS),
)
_HEAD: Final = "| name | type | MAVLink | profile or role | units and frame |\n|---|---|---|---|---|"


def render_table() -> str:
    """Return the whole table, a section for each kind."""
    return "\n\n".join(f"## {title}\n\n{_table(rows)}" for title, rows in _SECTIONS)


def render_differences() -> str:
    """Return the rows that differ from MAVROS, with the difference."""
    rows: tuple[Publication | Subscription | Service, ...] = (*PUBLICATIONS, *SUBSCRIPTIONS, *SERVICES)
    differing = [row for row in rows if row.difference and "not in MAVROS" not in row.difference]
    lines = [f"| `{row.name}` | {row.difference} |" for row in differing]
    return "\n".join(("| name | difference |", "|---|---|", *lines))


def render_metrics() -> str:
    """Return the metrics that are read from a vehicle."""
    lines = [f"| `{metric.name}` | {metric.text} |" for metric in METRICS]
    return "\n".join(("| metric | value |", "|---|---|", *lines))


def render_mqtt_topics() -> str:
    """Return the topics of a vehicle on MQTT."""
    lines = [f"| `{each.topic}` | {each.payload} | {each.when} |" for each in TOPICS]
    return "\n".join(("| topic | payload | |", "|---|---|---|", *lines))


def render_mqtt_commands() -> str:
    """Return the commands that the bridge to MQTT takes, with their arguments and roles."""
    return "\n".join(
        ("| command | needs | may have | role | effect |", "|---|---|---|---|---|", *map(_verb_line, VERBS))
    )


def _verb_line(name: str) -> str:
    verb = VERBS[name]
    needed, optional = (", ".join(f"`{each}`" for each in names) for names in (verb.needed, verb.optional))
    return f"| `{name}` | {needed} | {optional} | {verb.role.word} | {verb.meaning} |"


def _table(rows: Iterable[Row]) -> str:
    return "\n".join((_HEAD, *map(_line, rows)))


def _line(row: Row) -> str:
    package, _, name = row.type.split("/")
    if isinstance(row, Publication | Subscription):
        messages = row.sources if isinstance(row, Publication) else row.targets
        source, fits, meaning = ", ".join(map(name_of, messages)), row.qos.name, row.meaning
    else:
        source, fits, meaning = row.meaning, row.role.word, ""
    return f"| `{row.name}` | `{package}/{name}` | {source} | {fits} | {meaning} |"
