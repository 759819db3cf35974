"""Who is speaking: senders, and their claims on addresses. Sans-IO.

    claims: Claims[Channel] = Claims()
    claims.open(channel, Sender("udp:14550", "10.1.2.3:50000", Authority.KEY), now)
    standing = claims.hear(channel, (1, 1), now)            a packet of 1/1 came from it
    claims.holder((1, 1))                                   whose address it is
    claims.routes((1, 1))                                   which channels lead to it
    claims.contradict(channel, (1, 1), Contradiction.POSITION, now)

A sender is one channel: a stream, or one remote address of a UDP socket. Each packet is a claim on its
address (system, component). An authenticated claim outranks one that is not; among equals the sender that was
heard first holds the address while it is heard. Redundant links of a group share an address, as do ground
stations, which have one default address. Any other claim is contested, and leads nowhere.

The table is in the core (`rust/core/src/claims.rs`, which has all rules), and is bounded: 4,096 senders and
addresses, 32 claims on each address. The router has its own one, with its ports as senders.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING, Generic, TypeVar

from mavstack import _core

if TYPE_CHECKING:
    from collections.abc import Hashable

Key = TypeVar("Key", bound="Hashable")


class Authority(IntEnum):
    """How the identity of a sender is proven."""

    NONE = 0
    SESSION = 1
    TICKET = 2
    CERTIFICATE = 3
    KEY = 4


class Standing(IntEnum):
    """The standing of a sender's claim on an address."""

    #: The sender holds the address.
    HELD = 0
    #: The sender holds the address now, and no other sender claimed it before.
    NEW = 1
    #: The sender is a redundant link of the holder, or its packets have the same boot time.
    SHARED = 2
    #: Another sender, whose authority is not higher, holds the address.
    CONTESTED = 3
    #: An authenticated sender holds the address, and this sender is not authenticated.
    OUTRANKED = 4

    @property
    def is_trusted(self) -> bool:
        """True if packets of the address from this sender are as good as those of its holder."""
        return self <= Standing.SHARED


class BootClock(IntEnum):
    """The comparison of the boot time of a packet with those before."""

    AGREES = 0
    REBOOTED = 1
    #: The boot time contradicts the holder's, and the sender does not hold the address.
    DIFFERS = 2


class Contradiction(IntEnum):
    """A property in which two packets of one address contradict each other."""

    SENDER = 0
    BOOT_TIME = 1
    UNIQUE_ID = 2
    TYPE = 3
    POSITION = 4


@dataclass(frozen=True, slots=True)
class Sender:
    """A sender: one channel, its remote address and its credential.

    Attributes:
        place: Name of the link that the channel belongs to.
        remote: Its remote address, such as `10.1.2.3:50000`; empty: it has no address, as a serial port.
        authority: How its identity is proven.
        identity: The proven identity: the name of the key, ticket, certificate or session.
        group: Name of the group of redundant links that the link belongs to; empty: no group.
    """

    place: str
    remote: str = ""
    authority: Authority = Authority.NONE
    identity: str = ""
    group: str = ""

    @property
    def is_authenticated(self) -> bool:
        """True if its identity is proven."""
        return self.authority is not Authority.NONE

    @property
    def host(self) -> str:
        """The host of the remote address; the place if there is no address."""
        return self.remote.rpartition(":")[0] or self.remote or self.place

    @property
    def quarantine_key(self) -> str:
        """The key of a quarantine: the proven identity, or the remote address of an unauthenticated sender.

        A quarantine of the one never includes the other.
        """
        if self.is_authenticated:
            return f"{self.authority.name.lower()} {self.identity or self.place}"
        return f"{self.place} {self.remote}"

    def __str__(self) -> str:
        where = f"{self.place} from {self.remote}" if self.remote else self.place
        return f"{where} ({self.authority.name.lower()} {self.identity})" if self.is_authenticated else where


@dataclass(frozen=True, slots=True)
class Claim(Generic[Key]):
    """The claim of one sender on one address.

    Attributes:
        key: The key of the sender.
        sender: The sender.
        authority: The best proof of its packets.
        since: Time of its first packet in seconds; a silence of more than a minute ends an earlier claim.
        heard_at: Time of its last packet in seconds.
        leads: Packets for the address go to it.
        has_clock: Its boot clock is that of the holder.
        is_station: Its last heartbeat was that of a ground station.
    """

    key: Key
    sender: Sender
    authority: Authority
    since: float
    heard_at: float
    leads: bool
    has_clock: bool
    is_station: bool


@dataclass(frozen=True, slots=True)
class Conflict(Generic[Key]):
    """A conflict about an address.

    Attributes:
        began_at: Time of the first contradiction in seconds.
        contradicted_at: Time of the last one in seconds; 30 seconds later it ends.
        keys: The keys of the senders that it is between, at most four.
        contradictions: What was contradicted.
    """

    began_at: float
    contradicted_at: float
    keys: tuple[Key, ...]
    contradictions: frozenset[Contradiction]


class Claims(Generic[Key]):
    """The claims of senders on addresses. Times are in seconds, of any clock that does not run back.

    Args:
        silence: Seconds without a packet after which another sender may hold an address.
    """

    def __init__(self, silence: float = 2.5) -> None:
        self._core = _core.Claims(silence)
        self._numbers: dict[Key, int] = {}
        self._keys: dict[int, tuple[Key, Sender]] = {}

    # Methods for senders

    def open(self, key: Key, sender: Sender, now: float) -> bool:
        """Add a sender, or change one.

        Args:
            key: Its key, such as the channel.
            sender: The sender.
            now: Time in seconds.

        Returns:
            False if there are 4,096 senders already.
        """
        self.close(key)
        place, group = _number(sender.place), _number(sender.group)
        number = self._core.open(place, group, _host(sender), sender.authority, now)
        if number is None:
            return False
        self._numbers[key], self._keys[number] = number, (key, sender)
        return True

    def close(self, key: Key) -> None:
        """Remove a sender and its claims. Idempotent.

        Args:
            key: Its key.
        """
        number = self._numbers.pop(key, None)
        if number is not None:
            del self._keys[number]
            self._core.close(number)

    def authenticate(self, key: Key, authority: Authority, identity: str = "") -> None:
        """Change the proof of a sender; what an earlier one proved is withdrawn.

        Args:
            key: Its key.
            authority: The proof from now on; `Authority.NONE` withdraws it.
            identity: The proven identity.
        """
        number = self._numbers[key]
        before = self._keys[number][1]
        sender = Sender(before.place, before.remote, authority, identity, before.group)
        self._keys[number] = key, sender
        self._core.set_authority(number, authority)

    def withdraw(self, key: Key) -> None:
        """Forget what authenticated single packets of a sender: its key was changed or removed.

        Args:
            key: Its key.
        """
        number = self._numbers.get(key)
        if number is not None:
            self._core.set_authority(number, self._keys[number][1].authority)

    def sender(self, key: Key) -> Sender | None:
        """Return the sender of a key; None: it is not open."""
        number = self._numbers.get(key)
        return None if number is None else self._keys[number][1]

    def touch(self, key: Key, now: float) -> None:
        """Record that bytes came from a sender, whatever they are.

        Args:
            key: Its key.
            now: Time in seconds.
        """
        self._core.touch(self._numbers[key], now)

    def first_to_evict(self, newcomer: Sender, now: float, *, everywhere: bool = False) -> Key | None:
        """Return the sender that makes room for a new one.

        Unauthenticated senders make room first: of these the ones of a host with more than 8, then those that
        were heard for less than a second, then those that have been silent for longest. A sender that is no
        worse proven than the newcomer makes room only if its host is more crowded, or after a second without
        data if it was heard for a moment, or after 10 seconds. An authenticated one never makes room for one
        that is not.

        Args:
            newcomer: The new sender.
            now: Time in seconds.
            everywhere: Senders of all places may make room, not only those of the newcomer's.

        Returns:
            The key of the sender to close; None: the newcomer is refused.
        """
        place = None if everywhere else _number(newcomer.place)
        number = self._core.first_to_evict(place, _host(newcomer), newcomer.authority, now)
        return None if number is None else self._keys[number][0]

    # Methods for claims

    def hear(
        self, key: Key, address: tuple[int, int], now: float, authority: Authority = Authority.NONE
    ) -> Standing:
        """Record a packet.

        Args:
            key: The key of the sender that it came from.
            address: Its system and component id.
            now: Time in seconds.
            authority: The proof of this packet, such as its signature; that of the sender counts too.

        Returns:
            The standing of the claim.
        """
        return Standing(self._core.hear(self._numbers[key], *address, authority, now))

    def standing(
        self, key: Key, address: tuple[int, int], now: float, authority: Authority = Authority.NONE
    ) -> Standing:
        """Return the standing that a packet would have, and record nothing; see `hear`."""
        return Standing(self._core.standing(self._numbers[key], *address, authority, now))

    def note_ground_station(self, key: Key, address: tuple[int, int], *, is_station: bool) -> None:
        """Record whether a heartbeat is that of a ground station.

        Args:
            key: The key of the sender that it came from.
            address: Its system and component id.
            is_station: Its type is MAV_TYPE_GCS.
        """
        self._core.note_ground_station(self._numbers[key], *address, is_station)

    def note_boot_time(self, key: Key, address: tuple[int, int], time_boot_ms: int, now: float) -> BootClock:
        """Record a boot time.

        Args:
            key: The key of the sender that it came from.
            address: Its system and component id.
            time_boot_ms: Milliseconds since the boot.
            now: Time in seconds.

        Returns:
            The comparison with the boot times before.
        """
        return BootClock(self._core.note_boot_time(self._numbers[key], *address, time_boot_ms, now))

    def holder(self, address: tuple[int, int]) -> Claim[Key] | None:
        """Return the claim of the sender that holds an address; None: it was never heard."""
        return next(iter(self.claims_on(address)), None)

    def claims_on(self, address: tuple[int, int]) -> list[Claim[Key]]:
        """Return the claims on an address, the holder's first."""
        return [
            Claim(*self._keys[number], Authority(authority), since, heard_at, leads, has_clock, is_station)
            for number, authority, since, heard_at, leads, has_clock, is_station in self._core.claims_on(
                *address
            )
        ]

    def routes(self, address: tuple[int, int]) -> list[Key] | None:
        """Return the keys of the senders that lead to a target; None: its system was never heard.

        Component 0, and a component that was never heard, are reached over all senders of their system.
        """
        found = self._core.routes(*address)
        return None if found is None else [self._keys[number][0] for number in found]

    def is_authenticated(self, address: tuple[int, int]) -> bool:
        """Return whether an authenticated sender holds an address."""
        return self._core.is_authenticated(*address)

    def addresses(self) -> list[tuple[int, int]]:
        """Return all claimed addresses, ordered."""
        return self._core.addresses()

    # Methods for conflicts

    def contradict(
        self, key: Key, address: tuple[int, int], contradiction: Contradiction, now: float
    ) -> bool:
        """Record a contradiction that a detector found.

        An unauthenticated sender cannot contradict an authenticated holder.

        Args:
            key: The key of the sender of the newer packet.
            address: Its system and component id.
            contradiction: What is contradicted.
            now: Time in seconds.

        Returns:
            True if a conflict begins.
        """
        return self._core.contradict(self._numbers[key], *address, contradiction, now)

    def conflict(self, address: tuple[int, int]) -> Conflict[Key] | None:
        """Return the conflict about an address; None: there is no conflict."""
        found = self._core.conflict(*address)
        if found is None:
            return None
        began_at, contradicted_at, numbers, kinds = found
        keys = tuple(self._keys[number][0] for number in numbers if number in self._keys)
        return Conflict(began_at, contradicted_at, keys, frozenset(Contradiction(kind) for kind in kinds))

    def end_conflicts(self, now: float) -> list[tuple[int, int]]:
        """End the conflicts without a contradiction in 30 seconds, and return their addresses."""
        return self._core.end_conflicts(now)


def _number(name: str) -> int:
    """Return the number of a place or group; 0 for no name."""
    return (hash(name) & 0x7FFF_FFFF_FFFF_FFFF) | 1 if name else 0


def _host(sender: Sender) -> int:
    return hash(sender.host) & 0xFFFF_FFFF_FFFF_FFFF
