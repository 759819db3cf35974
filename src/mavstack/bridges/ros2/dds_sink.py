"""ROS 2 over DDS by Cyclone DDS, without a ROS installation: topics only.

Services of ROS over DDS need a property of requests that the Python API of Cyclone DDS does not offer. The
samples are our own CDR: the classes that Cyclone wants describe the types, and hand the bytes through.
"""

from __future__ import annotations

import asyncio
import os
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.sink import Handoff, Outbox
from mavstack.bridges.core.types import Definition, FieldType, codec_of, definition_of, type_hash
from mavstack.bridges.core.types.model import Container
from mavstack.errors import MissingExtraError

if TYPE_CHECKING:
    from mavstack.bridges.core.endpoints import Inlet, ServiceEndpoint
    from mavstack.bridges.core.qos import Qos
    from mavstack.bridges.core.topic import Topic

#: Seconds between two checks whether a topic has subscribers.
MATCH_INTERVAL: Final = 0.25
#: Maximum number of samples that are taken from a reader at once.
MAX_TAKEN: Final = 64
#: Cyclone DDS rejects the type objects of Fast DDS and then drops its samples without an error; this setting
#: makes it ignore them. 1.15 is the vendor id of Fast DDS.
_CONFIG: Final = (
    "<CycloneDDS><Domain Id='any'><Compatibility><IgnoreTypeInformation>1.15</IgnoreTypeInformation>"
    "</Compatibility>{local}</Domain></CycloneDDS>"
)
_LOCAL: Final = (
    "<General><Interfaces><NetworkInterface name='lo' multicast='false'/></Interfaces>"
    "<AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex>"
    "<MaxAutoParticipantIndex>32</MaxAutoParticipantIndex><Peers><Peer Address='127.0.0.1'/></Peers>"
    "</Discovery>"
)
_GRAPH_TYPE: Final = "rmw_dds_common/msg/ParticipantEntitiesInfo"
_TYPES: Final = {"bool": bool, "string": str, "byte": "uint8", "char": "uint8"}


class DdsSink:
    """The bus of ROS 2 over DDS.

    Args:
        domain: The ROS_DOMAIN_ID.

    Raises:
        MissingExtraError: cyclonedds is not installed.
    """

    def __init__(self, domain: int) -> None:
        try:
            import_module("cyclonedds.core")
        except ImportError:
            raise MissingExtraError("ROS 2 over DDS", "dds") from None
        self._domain = domain
        self._publishers: list[_TopicWriter] = []
        self._nodes: dict[str, tuple[list[bytes], list[bytes]]] = {}
        self._kept: list[Any] = []
        self._watch: asyncio.Task[None] | None = None
        self._changed = False
        self._participant: Any = None

    async def open(self) -> None:
        """Join the domain."""
        domain: Any = import_module("cyclonedds.domain")
        policy = _policies()
        local = _LOCAL if os.environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE") == "LOCALHOST" else ""
        if "CYCLONEDDS_URI" not in os.environ:
            self._kept.append(domain.Domain(self._domain, _CONFIG.format(local=local)))
        loop = asyncio.get_running_loop()
        self._samples: Handoff[tuple[Inlet, bytes, str, int]] = Handoff(
            loop, lambda item: item[0].receive(*item[1:])
        )
        self._outbox: Outbox[tuple[Any, Any]] = Outbox(lambda item: item[0].write(item[1]), name="dds")
        core: Any = import_module("cyclonedds.core")
        qos = core.Qos(policy.Userdata(b"enclave=/;"))
        self._participant = domain.DomainParticipant(self._domain, qos=qos)
        self._graph = self._writer("ros_discovery_info", _GRAPH_TYPE, reliable=True, latched=True, depth=1)
        self._watch = loop.create_task(self._match())

    async def close(self) -> None:
        """Leave the domain. Idempotent."""
        if self._watch is None:
            return
        self._watch.cancel()
        self._watch = None
        self._outbox.close()
        self._publishers.clear()
        self._kept.clear()
        self._graph = self._participant = None

    def add_node(self, namespace: str, name: str) -> None:
        """Announce a node."""
        self._nodes[f"{namespace}/{name}"] = ([], [])
        self._changed = True

    def add_topic(self, topic: Topic) -> None:
        """Create a writer, and write while it has readers."""
        qos = topic.qos
        writer = self._writer(
            f"rt{topic.name}", topic.type, reliable=qos.reliable, latched=qos.latched, depth=qos.depth
        )
        self._publishers.append(_TopicWriter(topic, writer, self._outbox))
        self._nodes[topic.node][1].append(writer.guid.bytes)
        self._changed = True

    def add_inlet(self, inlet: Inlet) -> None:
        """Create a reader."""
        sub: Any = import_module("cyclonedds.sub")
        core: Any = import_module("cyclonedds.core")
        put = self._samples.put

        class Arrived(core.Listener):  # type: ignore[misc]
            """Hand samples over; called in a thread of Cyclone."""

            def on_data_available(self, reader: Any) -> None:  # noqa: ANN401
                for sample in reader.take(MAX_TAKEN):
                    if hasattr(sample, "payload"):  # a sample without payload: a writer ended
                        info = sample.sample_info
                        put((inlet, sample.payload, str(info.publication_handle), info.source_timestamp))

        topic = self._topic(f"rt{inlet.name}", inlet.type)
        reader = sub.DataReader(self._participant, topic, _qos(inlet.qos, inlet.type), Arrived())
        self._kept.append(reader)
        self._nodes[inlet.node][0].append(reader.guid.bytes)
        self._changed = True

    def add_service(self, service: ServiceEndpoint) -> None:
        """Do nothing: there are no services over DDS."""

    def _topic(self, name: str, type_name: str) -> Any:  # noqa: ANN401
        module: Any = import_module("cyclonedds.topic")
        return module.Topic(self._participant, name, _class_of(type_name))

    def _writer(self, name: str, type_name: str, *, reliable: bool, latched: bool, depth: int) -> Any:  # noqa: ANN401
        from mavstack.bridges.core.qos import Qos

        pub: Any = import_module("cyclonedds.pub")
        qos = _qos(Qos("", reliable=reliable, latched=latched, depth=depth), type_name)
        return pub.DataWriter(self._participant, self._topic(name, type_name), qos)

    async def _match(self) -> None:
        while True:
            for publisher in self._publishers:
                publisher.update()
            if self._changed:
                self._changed = False
                self._write_graph()
            await asyncio.sleep(MATCH_INTERVAL)

    def _write_graph(self) -> None:
        """Announce which node has which readers and writers."""
        nodes = []
        for full, (readers, writers) in self._nodes.items():
            namespace, _, name = full.rpartition("/")
            gids = {"reader_gid_seq": _gids(readers), "writer_gid_seq": _gids(writers)}
            nodes.append({"node_namespace": namespace, "node_name": name, **gids})
        fields = {"gid": {"data": self._participant.guid.bytes}, "node_entities_info_seq": nodes}
        self._outbox.put((self._graph, _sample(_GRAPH_TYPE, codec_of(_GRAPH_TYPE).encode_fields(fields))))

    @property
    def dropped(self) -> int:
        """The number of samples that were dropped because DDS or the vehicle was too slow."""
        return self._samples.dropped + self._outbox.dropped


class _TopicWriter:
    """A topic in DDS, which is active while it has readers."""

    def __init__(self, topic: Topic, writer: Any, outbox: Outbox[tuple[Any, Any]]) -> None:  # noqa: ANN401
        self._topic = topic
        self._writer = writer
        self._outbox = outbox
        self._matching = False
        self.update()

    def update(self) -> None:
        """Follow the number of readers."""
        matching = self._topic.qos.latched or bool(self._writer.get_matched_subscriptions())
        if matching != self._matching:
            self._matching = matching
            if matching:
                self._topic.add_receiver(self._receive)
            else:
                self._topic.remove_receiver(self._receive)

    def _receive(self, payload: bytes, _stamp: int) -> None:
        self._outbox.put((self._writer, _sample(self._topic.type, payload)))


def _serialize(sample: Any, **options: object) -> bytes:  # noqa: ANN401
    """Return the CDR of a sample, in the place of Cyclone's encoder."""
    del options
    payload: bytes = sample.payload
    return payload


def _deserialize(kind: Any, data: bytes, /, **options: object) -> Any:  # noqa: ANN401
    """Return a sample of CDR, in the place of Cyclone's decoder."""
    del options
    made = kind.__new__(kind)
    made.payload = bytes(data)
    return made


def _sample(type_name: str, payload: bytes) -> Any:  # noqa: ANN401
    return _class_of(type_name).deserialize(payload)


@cache
def _class_of(type_name: str) -> Any:  # noqa: ANN401
    """Return the class that describes a type to Cyclone, whose samples are their CDR."""
    made = _description(definition_of(type_name))
    made.serialize = _serialize
    made.deserialize = classmethod(_deserialize)
    return made


@cache
def _description(definition: Definition) -> Any:  # noqa: ANN401
    idl: Any = import_module("cyclonedds.idl")
    name = definition.dds_name.rpartition("::")[2]
    fields = {field.name: _type(field.type) for field in definition.fields}
    return idl.make_idl_struct(name, definition.dds_name, fields, dataclassify=False)


def _type(kind: FieldType) -> Any:  # noqa: ANN401
    types: Any = import_module("cyclonedds.idl.types")
    if kind.is_message:
        one = _description(definition_of(kind.base))
    elif kind.base == "string" and kind.text_bound:
        one = types.bounded_str[kind.text_bound]
    else:
        known = _TYPES.get(kind.base, kind.base)
        one = getattr(types, known) if isinstance(known, str) else known
    if kind.container is Container.ONE:
        return one
    if kind.container is Container.ARRAY:
        return types.array[one, kind.size]
    return types.sequence[one, kind.size] if kind.size else types.sequence[one]


def _policies() -> Any:  # noqa: ANN401
    core: Any = import_module("cyclonedds.core")
    return core.Policy


def _qos(qos: Qos, type_name: str) -> Any:  # noqa: ANN401
    core: Any = import_module("cyclonedds.core")
    policy = core.Policy
    reliability = policy.Reliability
    return core.Qos(
        reliability.Reliable(10_000_000) if qos.reliable else reliability.BestEffort,
        policy.Durability.TransientLocal if qos.latched else policy.Durability.Volatile,
        policy.History.KeepLast(qos.depth),
        policy.DataRepresentation(use_cdrv0_representation=True, use_xcdrv2_representation=False),
        policy.Userdata(f"typehash={type_hash(type_name)};".encode()),
    )


def _gids(gids: list[bytes]) -> list[dict[str, bytes]]:
    return [{"data": gid} for gid in gids]
