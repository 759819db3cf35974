"""The engine of the router: it forwards packets between endpoints, on a thread of its own and without Python.

    engine = RouterEngine(ardupilotmega)
    autopilot = engine.add_stream(serial.fileno(), name="autopilot")
    ground = engine.add_udp(listener.fileno(), name="ground", start=False)
    engine.set_rules(ground, RuleSet(incoming=(Rule("drop", commands=frozenset({400})),)))
    engine.start(ground)                                       # no packet passed before the rules

An endpoint is a UDP socket, a stream, or a queue whose bytes the program carries. Each sender to a listening
UDP socket is a peer with routes of its own. Descriptors are duplicated, so the caller may close its own; they
become non-blocking.

A sender to a listening UDP socket is a peer when a packet of it was accepted: one that is refused, by its
signature or by a rule, gets nothing. The address of a new peer may be invented, so it gets no more than
three times the bytes that it sent, and only heartbeats and packets with a target, until it answers: it sends
a packet to an address of another port, a COMMAND_ACK, PARAM_VALUE, TIMESYNC or AUTOPILOT_VERSION, or one
with a verified signature. Of the peers that sent one datagram so far, eight get packets without a
target, for ten seconds; the others get them from their second datagram on.

Packets leave as they came, byte for byte. A packet with a target goes to every endpoint on which its target
was heard, or, if only the system of the target is known, to every endpoint on which that was heard; a packet
without one goes to all others. A packet never goes back to where it came from, nor to another endpoint of the
same group. RADIO_STATUS and SETUP_SIGNING stay on their link. A packet that comes back over a redundant path
is dropped (`loop`), and so are copies that links of one group deliver (`duplicate`). A monitor gets a copy of
every packet that is accepted, whatever its target.

All methods are thread-safe, and only `statistics`, `synchronize` and `close` wait for the thread of the
engine: for one turn of it, normally less than a millisecond. Changes are made in the order of the calls.
`fileno` is readable while events wait. Nothing grows without bound: a slow stream or queue loses its own
packets, and events that are not taken are dropped. All of that is counted. An endpoint fills a queue at most
as far as it leaves room for others; packets with a target and heartbeats may fill four fifths. On a slow
stream the endpoints take turns, so that a packet waits for those of its own endpoint, and for one turn of
each other. Each link is read 64 kB at a time, so that a flood on one delays the others by some milliseconds.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack._core import RouterCore
from mavstack.errors import InvalidArgumentError, InvalidStateError

if TYPE_CHECKING:
    from collections.abc import Iterable
    from types import TracebackType
    from typing import Any, Literal, Self

    from typing_extensions import Buffer

    from mavstack._core import HasCoreDialect, RuleLayout, Signing
    from mavstack.router.engine_events import RouterEvent
    from mavstack.router.engine_statistics import RouterStatistics
    from mavstack.router.rules import Rule, RuleSet
    from mavstack.security.senders import Authority

#: Seconds without a packet after which a peer of a listening UDP socket is removed.
DEFAULT_IDLE = 60.0
DEFAULT_MAX_PEERS = 64
#: Size of the send queue of a stream in bytes, and of a queue endpoint in packets.
DEFAULT_QUEUE_BYTES = 256 << 10
DEFAULT_QUEUE_PACKETS = 4096

#: The error text after an internal error has ended the engine.
ENDED = "the router engine ended by an internal error: start the router again"


class RouterEngine:
    """A running engine. A context manager; closing it closes its endpoints.

    Args:
        dialect: A `mavstack.Dialect` or a dialect module. Other messages are forwarded too, to all endpoints.
        duplicate_window: Seconds within which copies of a packet from other endpoints are dropped; 0: only
            copies on links of one group, and packets that come back.

    Raises:
        OSError: The system has no more threads or descriptors.
    """

    def __init__(self, dialect: HasCoreDialect, *, duplicate_window: float = 0.0) -> None:
        if not 0 <= duplicate_window <= 3600:
            raise InvalidArgumentError(
                f"the duplicate window must be 0 to 3600 seconds, got {duplicate_window}"
            )
        self._core = RouterCore(dialect, duplicate_window)
        self._names: dict[int, str] = {}
        self._is_closed = False

    # Endpoints

    def add_udp(
        self,
        fd: int,
        *,
        name: str,
        peer: tuple[str, int] | None = None,
        idle: float = DEFAULT_IDLE,
        max_peers: int = DEFAULT_MAX_PEERS,
        trusts_senders: bool = False,
        start: bool = True,
    ) -> int:
        """Add a UDP socket.

        Args:
            fd: Descriptor of a bound socket.
            name: Name in statistics.
            peer: IP address and port of the only peer; other senders are ignored, unless it is a broadcast or
                multicast address. None: every sender of a packet that is accepted becomes a peer.
            idle: Seconds of silence after which a peer is removed.
            max_peers: Maximum number of peers; a new one replaces a silent one, or is refused; one with a
                verified signature replaces any that has none.
            trusts_senders: Send everything to new peers at once; False: see the head of the module.
            start: False: nothing passes the endpoint before `start`.

        Returns:
            The number of the endpoint, which is never used again.

        Raises:
            InvalidArgumentError: The address of the peer is not an IP address.
            InvalidStateError: The engine is closed.
            OSError: The descriptor is not open.
        """
        self._check_open()
        try:
            return self._named(
                self._core.add_udp(fd, peer, idle, max_peers, trusts_senders), name, start=start
            )
        except ValueError as error:
            raise InvalidArgumentError(f"adding endpoint {name} failed: {error}") from None

    def add_stream(
        self,
        fd: int,
        *,
        name: str,
        framing: Literal["none", "length"] = "none",
        queue_bytes: int = DEFAULT_QUEUE_BYTES,
        start: bool = True,
    ) -> int:
        """Add a stream: a connected TCP or Unix socket, a serial port, a terminal.

        Args:
            fd: Its descriptor.
            name: Name in statistics.
            framing: `"length"`: a 4-byte big-endian length before each packet, in both directions.
            queue_bytes: Bytes that wait to be sent; packets that exceed them, or the share of the
                endpoint that they come from, are dropped.
            start: False: nothing passes the endpoint before `start`.

        Returns:
            The number of the endpoint, which is never used again.

        Raises:
            InvalidArgumentError: The framing is unknown.
            InvalidStateError: The engine is closed.
            OSError: The descriptor is not open.
        """
        self._check_open()
        if framing not in ("none", "length"):
            raise InvalidArgumentError(f'framing must be "none" or "length", got {framing!r}')
        return self._named(self._core.add_stream(fd, framing == "length", queue_bytes), name, start=start)

    def add_queue(
        self,
        *,
        name: str,
        capacity: int = DEFAULT_QUEUE_PACKETS,
        monitor: bool = False,
        start: bool = True,
    ) -> int:
        """Add an endpoint whose bytes the program carries.

        Args:
            name: Name in statistics.
            capacity: Packets that wait to be pulled; packets that exceed them, or the share of the
                endpoint that they come from, are dropped.
            monitor: It gets a copy of every accepted packet, see `set_monitor`.
            start: False: nothing passes the endpoint before `start`.

        Returns:
            The number of the endpoint, which is never used again.

        Raises:
            InvalidStateError: The engine is closed.
        """
        self._check_open()
        number = self._core.add_queue(capacity)
        self._core.set_monitor(number, monitor)
        return self._named(number, name, start=start)

    def start(self, endpoint: int) -> None:
        """Let packets pass an endpoint that was added with `start=False`. Idempotent."""
        self._core.start(endpoint)

    def push(self, endpoint: int, data: Buffer) -> bool:
        """Route bytes that came from a queue endpoint, in chunks of any size.

        Returns:
            False if 4 MB wait to be routed already: nothing was taken, and the caller may try again.

        Raises:
            InvalidArgumentError: The endpoint is no queue.
        """
        taken = self._core.push(endpoint, data)
        if taken is None:
            raise self._no_queue(endpoint)
        return taken

    def pull(self, endpoint: int) -> list[bytes]:
        """Return the packets for a queue endpoint, oldest first.

        Raises:
            InvalidArgumentError: The endpoint is no queue.
        """
        packets = self._core.pull(endpoint)
        if packets is None:
            raise self._no_queue(endpoint)
        return packets

    def remove(self, endpoint: int) -> None:
        """Route what was pushed to an endpoint, remove it and close its descriptor. Idempotent."""
        self._names.pop(endpoint, None)
        self._core.remove(endpoint)

    # Options

    def pause(self, endpoint: int, paused: bool) -> None:
        """Drop all packets from and to an endpoint, or forward them again."""
        self._core.pause(endpoint, paused)

    def set_rules(self, endpoint: int, rules: RuleSet) -> None:
        """Replace the rules of an endpoint; their counters start at 0."""
        self._core.set_rules(
            endpoint,
            [_layout(rule) for rule in rules.incoming],
            [_layout(rule) for rule in rules.outgoing],
            rules.default_incoming,
            rules.default_outgoing,
            rules.bytes_per_second,
        )

    def set_group(self, endpoint: int, group: str | None) -> None:
        """Make an endpoint one of the redundant links of a group; None: of none."""
        self._core.set_group(endpoint, group)

    def set_listen_only(self, endpoint: int, listen_only: bool) -> None:
        """Drop the packets that come from an endpoint, or accept them again; it still gets those for it."""
        self._core.set_listen_only(endpoint, listen_only)

    def set_monitor(self, endpoint: int, monitor: bool) -> None:
        """Give an endpoint a copy of every accepted packet, or make it an ordinary endpoint again.

        A packet is accepted when the incoming rules of its endpoint pass it and it is no copy. A monitor gets
        it whatever its target, if the outgoing rules of the monitor pass it. Packets from a monitor are
        dropped, and it is never a route.
        """
        self._core.set_monitor(endpoint, monitor)

    def set_allowed_peers(self, endpoint: int, ranges: Iterable[tuple[str, int, int, int]] | None) -> None:
        """Accept only some peers of a UDP socket; those that are peers already and not accepted are removed.

        Args:
            endpoint: The endpoint.
            ranges: Network address, prefix length, first and last port of each range; None: all peers.

        Raises:
            InvalidArgumentError: An address is not an IP address.
        """
        try:
            self._core.set_allowed_peers(endpoint, None if ranges is None else list(ranges))
        except ValueError as error:
            raise InvalidArgumentError(f"allowing peers failed: {error}") from None

    def set_blocked_peers(self, endpoint: int, peers: Iterable[tuple[str, int]]) -> None:
        """Cut off peers of a listening UDP socket: nothing comes from them, and nothing goes to them.

        Args:
            endpoint: The endpoint.
            peers: IP address and port of each; those of an earlier call that are not among them are free.

        Raises:
            InvalidArgumentError: An address is not an IP address.
        """
        try:
            self._core.set_blocked_peers(endpoint, list(peers))
        except ValueError as error:
            raise InvalidArgumentError(f"blocking peers failed: {error}") from None

    def set_authority(self, endpoint: int, authority: Authority) -> None:
        """Set how the identity of the peer of an endpoint is proven.

        Addresses that an authenticated peer uses are its own: packets of others in their name are dropped.

        Args:
            endpoint: The endpoint.
            authority: The proof; `Authority.NONE` withdraws it.
        """
        self._core.set_authority(endpoint, authority)

    def set_signing(
        self,
        endpoint: int,
        incoming: Signing | None = None,
        outgoing: Signing | None = None,
        *,
        allow_unsigned: Iterable[int] = (),
        strip: bool = True,
    ) -> None:
        """Verify the signatures of packets from an endpoint, and sign packets to it.

        The timestamps of a key are shared with the given objects, so that they can be stored. An address that
        was verified on an endpoint is reached over such endpoints alone, and its packets from others are
        dropped.

        Args:
            endpoint: The endpoint.
            incoming: Verifies packets; refused ones are dropped. None: signatures are not looked at.
            outgoing: Signs packets, in place of any signature that they have. MAVLink 1 packets become
                MAVLink 2 packets. None: signatures are left as they are.
            allow_unsigned: Message ids that are accepted unsigned. They do not teach routes.
            strip: Remove signatures that `incoming` verified; False: leave them.
        """
        self._core.set_signing(endpoint, incoming, outgoing, list(allow_unsigned), strip)

    # Events and statistics

    def decide(self, token: int, passed: bool) -> None:
        """Forward or drop a packet that waits for a decision; one that waited for 5 seconds was dropped."""
        self._core.decide(token, passed)

    def events(self) -> list[RouterEvent]:
        """Return the events since the last call, oldest first: see `RouterEvent`."""
        return self._core.events()

    def fileno(self) -> int:
        """Return a descriptor that is readable while events wait, for event loops."""
        return self._core.fileno()

    def statistics(self) -> RouterStatistics:
        """Return the counters of all endpoints and the learned routes.

        Raises:
            InvalidStateError: The engine is closed, or ended by an internal error.
        """
        from mavstack.router.engine_statistics import RouterStatistics

        return RouterStatistics.of(self._counted(), self._names)

    def synchronize(self) -> None:
        """Wait until all changes of the calls so far are made; raises as `statistics`."""
        self._counted()

    def _counted(self) -> dict[str, Any]:
        self._check_open()
        try:
            return self._core.statistics()
        except RuntimeError:
            raise InvalidStateError(ENDED) from None

    def close(self) -> None:
        """Close all endpoints and end the thread. Idempotent."""
        self._is_closed = True
        self._core.close()

    def _named(self, number: int, name: str, *, start: bool) -> int:
        self._names[number] = name
        if start:
            self._core.start(number)
        return number

    def _no_queue(self, endpoint: int) -> InvalidArgumentError:
        name = self._names.get(endpoint)
        return InvalidArgumentError(
            f"endpoint {endpoint} is not open" if name is None else f"endpoint {name} is not a queue"
        )

    def _check_open(self) -> None:
        if self._is_closed:
            raise InvalidStateError("the router engine is closed")

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def _layout(rule: Rule) -> RuleLayout:
    return (
        rule.action,
        sorted(rule.messages),
        sorted(rule.systems),
        sorted(rule.components),
        sorted(rule.target_systems),
        sorted(rule.commands),
        rule.rate,
        rule.name,
        rule.dry_run,
    )
