"""Findings about the graph of ROS 2: who is connected with the vehicles, and why others are not.

Two endpoints of one name meet only if type and type hash are equal and the quality of service fits; ROS and
Zenoh are silent about the others.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.bridges.core.finding import Finding
from mavstack.bridges.core.names import NODE, PARAMETER_NODE
from mavstack.bridges.ros2.zenoh_keys import CLIENT, PUBLISHER, SERVER, SUBSCRIPTION
from mavstack.bridges.ros2.zenoh_keys import NODE as NODE_KIND

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from mavstack.bridges.core.qos import Qos
    from mavstack.bridges.ros2.zenoh_keys import GraphEntity

_OURS: Final = (NODE, PARAMETER_NODE)
#: Number of parts of a DDS type name: package, kind, `dds_` and name.
_PARTS: Final = 4
_OPPOSITES: Final = {PUBLISHER: SUBSCRIPTION, SUBSCRIPTION: PUBLISHER, SERVER: CLIENT}
_VERBS: Final = {SUBSCRIPTION: "receives", PUBLISHER: "sends", CLIENT: "calls"}


def check_graph(entities: Sequence[GraphEntity], domain: int) -> list[Finding]:
    """Return the findings about bridges and their peers in the graph of a domain, problems first."""
    nodes = sorted({_node(each) for each in entities if each.kind == NODE_KIND and each.node == NODE})
    if not nodes:
        text = f"no vehicle is in domain {domain}: is the bridge running, with this domain and router?"
        return [Finding(False, text)]
    found = [Finding(True, f"{node} is in domain {domain}", node=node) for node in nodes]
    found += sorted(_pairs(entities), key=lambda each: (each.ok, each.name, each.node))
    if len(found) == len(nodes):
        text = "no other node uses a topic or service of the vehicles"
        found.append(Finding(True, text))
    return found


def _pairs(entities: Iterable[GraphEntity]) -> Iterator[Finding]:
    by_name: dict[tuple[str, str], list[GraphEntity]] = {}
    for each in entities:
        by_name.setdefault((each.name, each.kind), []).append(each)
    for own in (each for each in entities if each.node in _OURS and each.kind in _OPPOSITES):
        for other in by_name.get((own.name, _OPPOSITES[own.kind]), ()):
            if other.session != own.session:
                yield _compare(own, other)


def _compare(own: GraphEntity, other: GraphEntity) -> Finding:
    node = _node(other)
    problem = _problem(own, other)
    text = f"{node} and {own.name}: {problem}" if problem else f"{node} {_VERBS[other.kind]} {own.name}"
    return Finding(not problem, text, own.name, node)


def _problem(own: GraphEntity, other: GraphEntity) -> str:
    if own.dds_type != other.dds_type:
        return f"it uses the type {_type(other)}, the bridge {_type(own)}; they never meet"
    if own.hash != other.hash:
        return (
            f"it has another definition of {_type(own)} ({other.hash[:15]}…, not {own.hash[:15]}…); "
            "they never meet until it is built with the same version of the package"
        )
    if own.kind == PUBLISHER:
        return _mismatch(own.qos, other.qos, "the subscriber", "the bridge")
    if own.kind == SUBSCRIPTION:
        return _mismatch(other.qos, own.qos, "the bridge", "the publisher")
    return ""


def _mismatch(offered: Qos | None, requested: Qos | None, reader: str, writer: str) -> str:
    if offered is None or requested is None or offered.accepts(requested):
        return ""
    if requested.reliable and not offered.reliable:
        return f"{reader} wants reliable samples, {writer} offers best effort; use sensor data quality"
    return f"{reader} wants samples from before it joined, {writer} keeps none; use volatile"


def _node(entity: GraphEntity) -> str:
    return f"{entity.namespace.rstrip('/')}/{entity.node}"


def _type(entity: GraphEntity) -> str:
    parts = entity.dds_type.split("::")
    if len(parts) != _PARTS:
        return entity.dds_type
    return f"{parts[0]}/{parts[1]}/{parts[3].removesuffix('_')}"
