"""Roles of clients: observe, operate, administer.

A role allows the messages and commands of its own table and of those before it (see `role_tables`).

- **observe** reads: heartbeats, PING and TIMESYNC, requests for messages and parameters.
- **operate** flies: flight commands, missions, manual control, payloads, corrections of positions.
- **administer** does everything else: parameters, reboot, calibration, files, firmware, tunnels, and each
  message and command that is not in a table.

A command is checked in COMMAND_LONG, COMMAND_INT and in the items of a mission, since a vehicle would carry
it out later. A role says nothing of ids: pair it with rules for them where several clients share a network.
"""

from __future__ import annotations

from collections import Counter
from enum import IntEnum
from functools import cache
from typing import TYPE_CHECKING, Final

from mavstack.dialects import Dialect
from mavstack.security.observer_requests import ObserverRequests
from mavstack.security.role_tables import COMMANDS, MESSAGES
from mavstack.wire import Parser

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.wire import Packet

#: Messages with a field `command`, which is checked too.
COMMAND_MESSAGES: Final = ("COMMAND_LONG", "COMMAND_INT", "MISSION_ITEM", "MISSION_ITEM_INT")
#: The name in statistics for all messages and commands that are not in the tables.
UNKNOWN: Final = "unknown"
#: The value of MAV_AUTOPILOT_INVALID.
_NO_AUTOPILOT: Final = 8


class Role(IntEnum):
    """The role of a client; a higher role includes the lower ones."""

    OBSERVE = 1
    OPERATE = 2
    ADMINISTER = 3

    @property
    def word(self) -> str:
        """The name in options and files, such as `observe`."""
        return self.name.lower()

    @classmethod
    def from_word(cls, word: str) -> Role:
        """Return the role of a name.

        Args:
            word: `observe`, `operate` or `administer`.

        Returns:
            The role.

        Raises:
            ValueError: There is no such role.
        """
        for role in cls:
            if role.word == word:
                return role
        raise ValueError(f"there is no role {word!r}: observe, operate or administer")


def allows(role: Role, message_id: int, command: int | None = None) -> bool:
    """Return whether a role may send a message.

    Args:
        role: The role of the sender.
        message_id: The id of the message.
        command: The MAV_CMD of a command or a mission item; None for other messages.

    Returns:
        True if it may.
    """
    if role is Role.ADMINISTER:
        return True
    if message_id in _command_messages():
        needed = _command_roles().get(-1 if command is None else command, Role.ADMINISTER)
        return role >= max(needed, _message_roles().get(message_id, Role.ADMINISTER))
    return role >= _message_roles().get(message_id, Role.ADMINISTER)


def message_ids(role: Role) -> frozenset[int]:
    """Return the ids of the messages that a role may send; commands and mission items not with any command.

    Args:
        role: The role, not `ADMINISTER`, which may send all.

    Returns:
        The ids.
    """
    return frozenset(number for number, needed in _message_roles().items() if needed <= role)


def command_ids(role: Role) -> frozenset[int]:
    """Return the commands (MAV_CMD) that a role may send.

    Args:
        role: The role, not `ADMINISTER`, which may send all.

    Returns:
        The commands.
    """
    return frozenset(number for number, needed in _command_roles().items() if needed <= role)


class RoleFilter:
    """Removes from a client's bytes the packets that its role does not allow.

    An observer speaks with one pair of ids, those of its first packet, and its heartbeats are those of a
    ground station. Its requests pass once for all observers of the link.

    Args:
        role: The role of the client.
        requests: The requests of all observers of the link; None: those of this client alone.

    Attributes:
        refused: Removed packets by the name of the message, or of the command.
    """

    def __init__(self, role: Role, requests: ObserverRequests | None = None) -> None:
        self.role = role
        self.refused: Counter[str] = Counter()
        self._parser = Parser(_dialect())
        self._requests = requests or ObserverRequests()
        self._sender: tuple[int, int] | None = None

    def filter(self, data: bytes, now: float) -> bytes:
        """Return the allowed packets; a packet in parts comes with its last part, other bytes are removed.

        Args:
            data: Bytes of the client: any number of packets.
            now: The time in seconds.

        Returns:
            The packets as received.
        """
        return b"".join([packet.raw for packet in self.packets(data) if self._passes(packet, now)])

    def packets(self, data: bytes) -> list[Packet]:
        """Return the packets of a client that its role allows, before the limit on requests."""
        return [packet for packet in self._parser.feed(data) if self._allows(packet)]

    def _passes(self, packet: Packet, now: float) -> bool:
        """Return whether a packet of an observer has its own ids, and is within its limit of requests."""
        if self.role is not Role.OBSERVE:
            return True
        sender = packet.system, packet.component
        self._sender = self._sender or sender
        if sender != self._sender or _is_of_autopilot(packet):
            self.refused["ids of another"] += 1
            return False
        return self._requests.passes(packet.message, now)

    def _allows(self, packet: Packet) -> bool:
        command = packet.message.command if packet.message_id in _command_messages() else None
        if allows(self.role, packet.message_id, command):
            return True
        # one name for all unknown ids: a client could send millions of different ids
        name = packet.name or UNKNOWN
        if command is not None:
            name += f" {int(command)}" if command in _command_roles() else f" {UNKNOWN}"
        self.refused[name] += 1
        return False


def _is_of_autopilot(packet: Packet) -> bool:
    """Return whether a packet is a heartbeat of an autopilot."""
    return packet.name == "HEARTBEAT" and packet.message.autopilot != _NO_AUTOPILOT


@cache
def _dialect() -> Dialect:
    return Dialect.load("common")


@cache
def _command_messages() -> frozenset[int]:
    return frozenset(_dialect()[name].definition.id for name in COMMAND_MESSAGES)


@cache
def _message_roles() -> Mapping[int, Role]:
    return {
        _dialect()[name].definition.id: Role.from_word(word)
        for word, names in MESSAGES.items()
        for name in names.split()
    }


@cache
def _command_roles() -> Mapping[int, Role]:
    numbers = {member.name: int(member) for member in _dialect().enums["MAV_CMD"]}
    return {numbers[name]: Role.from_word(word) for word, names in COMMANDS.items() for name in names.split()}
