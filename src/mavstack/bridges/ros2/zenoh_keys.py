"""The wire of rmw_zenoh: keys, liveliness tokens, attachments. Pure functions, without Zenoh.

A topic or a service is the key `<domain>/<name>/<DDS type>/<type hash>`: peers with another definition of a
type never meet. What exists is announced by tokens, from which all peers build the graph of nodes and
endpoints:

    @ros2_lv/<domain>/<session>/<node>/<entity>/<kind>/<enclave>/<namespace>/<node name>
    … /<name>/<DDS type>/<type hash>/<quality of service>

Slashes inside a part are written as %. The numbers of the quality of service are those of rmw.
"""

from __future__ import annotations

from dataclasses import dataclass
from hashlib import blake2b
from struct import Struct, error
from typing import Final

from mavstack.bridges.core.qos import Qos
from mavstack.bridges.core.types import definition_of, type_hash

NODE, PUBLISHER, SUBSCRIPTION, SERVER, CLIENT = "NN", "MP", "MS", "SS", "SC"
ROOT: Final = "@ros2_lv"
GID_SIZE: Final = 16
_ATTACHMENT: Final = Struct(f"<qqB{GID_SIZE}s")
_RELIABLE, _BEST_EFFORT = 1, 2
_TRANSIENT_LOCAL, _VOLATILE = 1, 2
_KEEP_LAST: Final = 1
_NODE_PARTS: Final = 9
_ENDPOINT_PARTS: Final = 13
#: The QoS depth of a liveliness token whose QoS parts are empty.
_DEFAULT_DEPTH: Final = 10


def key_of(domain: int, name: str, type_name: str) -> str:
    """Return the key of a topic or a service.

    Args:
        domain: The ROS_DOMAIN_ID.
        name: The full name, such as "/mavros/state".
        type_name: The full name of the type, such as "mavros_msgs/msg/State".
    """
    definition = definition_of(type_name)
    return f"{domain}/{name.strip('/')}/{definition.dds_name}/{type_hash(type_name)}"


def attachment_of(sequence: int, stamp: int, gid: bytes) -> bytes:
    """Return the attachment of a sample or a reply.

    Args:
        sequence: The sequence number, from 1.
        stamp: The time as Unix nanoseconds.
        gid: The id of the endpoint, 16 bytes.
    """
    return _ATTACHMENT.pack(sequence, stamp, GID_SIZE, gid)


def parse_attachment(data: bytes) -> tuple[int, int, bytes] | None:
    """Return sequence number, time and id in an attachment; None if it is not one."""
    try:
        sequence, stamp, size, gid = _ATTACHMENT.unpack(data)
    except error:
        return None
    return (sequence, stamp, gid) if size == GID_SIZE else None


def gid_of(token: str) -> bytes:
    """Return an id for an endpoint, which follows from its token."""
    return blake2b(token.encode(), digest_size=GID_SIZE).digest()


def qos_text(qos: Qos) -> str:
    """Return the part of a token that has the quality of service; all numbers are explicit."""
    reliability = _RELIABLE if qos.reliable else _BEST_EFFORT
    durability = _TRANSIENT_LOCAL if qos.latched else _VOLATILE
    return f"{reliability}:{durability}:{_KEEP_LAST},{qos.depth}:,:,:,,"


def parse_qos(text: str) -> Qos:
    """Return the quality of service in a token; parts that are empty or unknown have the defaults."""
    parts = [*text.split(":"), "", "", ""]
    depth = parts[2].partition(",")[2]
    return Qos(
        "",
        reliable=parts[0] != str(_BEST_EFFORT),
        latched=parts[1] == str(_TRANSIENT_LOCAL),
        depth=int(depth) if depth.isdecimal() else _DEFAULT_DEPTH,
    )


@dataclass(frozen=True, slots=True)
class GraphEntity:
    """A node or an endpoint, as its token announces it.

    Attributes:
        session: The id of the session, in hexadecimal digits.
        kind: NN, MP, MS, SS or SC.
        namespace: The namespace of the node, such as "/mavros".
        node: The name of the node.
        name: The name of the topic or service; empty for a node.
        dds_type: The DDS name of its type.
        hash: The type hash.
        qos: The quality of service; None for a node.
    """

    session: str
    kind: str
    namespace: str
    node: str
    name: str = ""
    dds_type: str = ""
    hash: str = ""
    qos: Qos | None = None


def node_token(domain: int, session: str, number: int, namespace: str, node: str) -> str:
    """Return the token of a node."""
    return f"{ROOT}/{domain}/{session}/{number}/{number}/{NODE}/%/{_mangled(namespace)}/{node}"


def endpoint_token(node: str, number: int, kind: str, name: str, type_name: str, *, qos: Qos) -> str:
    """Return the token of an endpoint.

    Args:
        node: The token of its node.
        number: The number of the endpoint in the session.
        kind: MP, MS, SS or SC.
        name: The full name of the topic or service.
        type_name: The full name of the type.
        qos: The quality of service.
    """
    parts = node.split("/")
    parts[4:6] = [str(number), kind]
    definition = definition_of(type_name)
    own = (_mangled(name), definition.dds_name, type_hash(type_name), qos_text(qos))
    return "/".join((*parts, *own))


def parse_token(key: str) -> GraphEntity | None:
    """Return the node or endpoint that a token announces; None if the key is not such a token."""
    parts = key.split("/")
    if parts[0] != ROOT or len(parts) not in (_NODE_PARTS, _ENDPOINT_PARTS):
        return None
    own = (parts[2], parts[5], _unmangled(parts[7]), parts[8])
    if len(parts) == _NODE_PARTS:
        return GraphEntity(*own)
    name, dds_type, hashed, qos = parts[9:]
    return GraphEntity(*own, _unmangled(name), dds_type, hashed, parse_qos(qos))


def _mangled(name: str) -> str:
    return name.replace("/", "%") or "%"


def _unmangled(text: str) -> str:
    return text.replace("%", "/")
