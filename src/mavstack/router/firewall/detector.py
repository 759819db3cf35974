"""The interface of detectors, and their registry.

A detector sees the packets of the messages that it names, in the order in which they arrive, and yields an
alert for what is not right. It has no sockets and no clock. Only rare messages are shown to detectors,
because these packets go through Python; a detector with `every_packet` sees all and is meant for slow links.
A detector also gets the counters of each endpoint once a second.

Detectors are registered by name. Other packages add them by entry points of the group
`mavstack.router_filters`: the entry point has the name of the detector and loads its class.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, Final

from mavstack.errors import InvalidArgumentError
from mavstack.plugins import Registry
from mavstack.router.firewall.alerts import Alert
from mavstack.security.senders import Sender
from mavstack.services import Address

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from importlib.metadata import EntryPoint
    from typing import Self

    from mavstack.dialects import Dialect
    from mavstack.router.config import Table
    from mavstack.wire import Packet

ENTRY_POINTS: Final = "mavstack.router_filters"


@dataclass(frozen=True, slots=True)
class Traffic:
    """The counters of one endpoint since it opened.

    Attributes:
        packets: Packets that came from it.
        bad_bytes: Bytes that came from it and belong to no valid packet.
    """

    packets: int
    bad_bytes: int


class Origin(str):
    """The name of the endpoint that a packet came from, or of its group, with the sender.

    Args:
        name: The name.
        sender: The sender; None: the only one of its link.
    """

    sender: Sender

    def __new__(cls, name: str, sender: Sender | None = None) -> Self:
        """Make the name of an origin."""
        made = super().__new__(cls, name)
        made.sender = sender or Sender(name)
        return made


def sender_of(origin: str) -> Sender:
    """Return the sender of an origin; a plain name is the only sender of its link."""
    return origin.sender if isinstance(origin, Origin) else Sender(origin)


class Detector:
    """The base class of detectors; a subclass overrides `inspect` or `measure`.

    Attributes:
        name: Name of the detector in the configuration.
        messages: Ids of the messages that it sees.
        every_packet: True if it sees all packets, which costs time for each.
    """

    name: ClassVar[str] = ""
    messages: frozenset[int] = frozenset()
    every_packet: ClassVar[bool] = False

    def configure(self, options: Table) -> None:
        """Read the options of the table `[firewall.detector.NAME]`.

        Args:
            options: The table, whose remaining keys are refused afterwards.

        Raises:
            RouterConfigError: An option is not valid.
        """

    def use_dialect(self, dialect: Dialect) -> None:
        """Take note of the dialect of the router, before any packet.

        Args:
            dialect: The dialect.
        """

    def inspect(self, origin: str, packet: Packet, now: float) -> Iterable[Alert]:
        """Look at a packet.

        Args:
            origin: Name of the endpoint that it came from, or of the group of the endpoint; `sender_of`
                returns the sender, which is one peer of a UDP port.
            packet: The packet.
            now: Time in seconds.

        Returns:
            Alerts; the packet is dropped if one of them refuses it.
        """
        return ()

    def measure(self, origin: str, traffic: Traffic, now: float) -> Iterable[Alert]:
        """Look at the counters of an endpoint, about once a second.

        Args:
            origin: Name of the endpoint.
            traffic: Its counters.
            now: Time in seconds.

        Returns:
            Alerts about the whole endpoint.
        """
        return ()

    def alert(self, origin: str, packet: Packet | None, text: str, *, refuse: bool = True) -> Alert:
        """Return an alert of this detector.

        Args:
            origin: Name of the endpoint or group.
            packet: The packet; None: the alert is about the whole endpoint.
            text: The reason.
            refuse: The packet is dropped.

        Returns:
            The alert.
        """
        source = None if packet is None else Address(packet.system, packet.component)
        return Alert(self.name, str(origin), source, text, refuse)


#: Module (in `mavstack.router.firewall.detectors`) and class of each built-in detector.
DETECTORS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "spoofed-ids": "spoofed_ids:SpoofedIds",
        "injected-positions": "injected_positions:InjectedPositions",
        "replays": "replays:Replays",
        "sequence": "sequence:SequenceAnomalies",
        "floods": "floods:Floods",
        "malformed": "malformed:MalformedFields",
        "behaviour": "behaviour:FlightBehaviour",
    }
)
#: The detectors of a firewall without the setting `detectors`: all that need only rare messages.
DEFAULT_DETECTORS: Final = tuple(name for name in DETECTORS if name != "sequence")


def _plugin_detector(entry: EntryPoint, loaded: Any) -> type[Detector]:  # noqa: ANN401 - of another package
    if not (isinstance(loaded, type) and issubclass(loaded, Detector)):
        raise InvalidArgumentError(f"{entry.value} is not a class of detectors")
    return loaded


_REGISTRY: Final[Registry[type[Detector]]] = Registry(
    "detector",
    ENTRY_POINTS,
    {name: f"mavstack.router.firewall.detectors.{place}" for name, place in DETECTORS.items()},
    convert=_plugin_detector,
)


def detector_names() -> tuple[str, ...]:
    """Return the names of all detectors, those of other packages included."""
    return _REGISTRY.names()


def make_detector(name: str) -> Detector:
    """Make a detector.

    Args:
        name: Its name.

    Returns:
        A new detector with its default options.

    Raises:
        InvalidArgumentError: There is no detector of this name, or its plug-in cannot be loaded.
    """
    return _REGISTRY.get(name)()


def messages_of(detectors: Iterable[Detector]) -> frozenset[int] | None:
    """Return the messages that detectors see together.

    Args:
        detectors: The detectors.

    Returns:
        The ids; None: all messages.
    """
    chosen = list(detectors)
    if any(detector.every_packet for detector in chosen):
        return None
    return frozenset().union(*(detector.messages for detector in chosen))


def make_room(table: dict[Any, Any], maximum: int) -> None:
    """Drop the oldest entries of a full table, so that forged sources cannot fill the memory.

    Args:
        table: A table in the order of its insertions.
        maximum: Entries that it may have after the next one is added.
    """
    while len(table) >= maximum:
        table.pop(next(iter(table)))
