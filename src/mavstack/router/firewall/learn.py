"""A rule set learned from a recorded flight, as a start for a firewall's configuration.

Every sender of the recording may send the messages, and the commands, that it sent. A flight does not show
all that a ground station can do, so the result is a dry run: its alerts of the next flights show the rest.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.services import Address, message_ids

if TYPE_CHECKING:
    from collections.abc import Iterable

    from mavstack.wire import Packet

#: Maximum number of senders in a recording; further ones are treated as noise.
MAX_SENDERS: Final = 256
_COMMANDS: Final = message_ids(common.CommandLong, common.CommandInt)
_WIDTH: Final = 100


@dataclass(slots=True)
class _Sent:
    packets: int = 0
    messages: set[int | str] = field(default_factory=set)
    commands: set[int | str] = field(default_factory=set)


class RuleLearner:
    """Collects the messages and commands of each sender."""

    def __init__(self) -> None:
        self._senders: dict[Address, _Sent] = {}

    @property
    def senders(self) -> int:
        """Number of senders."""
        return len(self._senders)

    def add(self, packets: Iterable[Packet]) -> None:
        """Take packets of a flight.

        Args:
            packets: The packets, in any order.
        """
        for packet in packets:
            sender = Address(packet.system, packet.component)
            if sender not in self._senders and len(self._senders) >= MAX_SENDERS:
                continue
            self._add(self._senders.setdefault(sender, _Sent()), packet)

    @staticmethod
    def _add(sent: _Sent, packet: Packet) -> None:
        sent.packets += 1
        if packet.message_id in _COMMANDS:
            command = packet.message.command
            sent.commands.add(getattr(command, "name", int(command)))
        else:
            sent.messages.add(packet.name or packet.message_id)

    def toml(self, title: str) -> str:
        """Return the rule set.

        Args:
            title: Name of the recording, for a comment.

        Returns:
            The table `[firewall]` as TOML.
        """
        lines = [
            f"# Learned from {title}. Read it, fly with it, look at its alerts,",
            "# then remove `dry_run`: from then on everything else is dropped.",
            "[firewall]",
            'default = "deny"',
            "dry_run = true",
        ]
        for sender, sent in sorted(self._senders.items()):
            lines += _rule(sender, sent)
        return "\n".join(lines) + "\n"


def _rule(sender: Address, sent: _Sent) -> list[str]:
    packets = f"{sent.packets} packet{'' if sent.packets == 1 else 's'}"
    lines: list[str] = []
    for kind, values in (("messages", sent.messages), ("commands", sent.commands)):
        if values:
            lines += [
                "",
                f"[[firewall.rule]]  # {packets}",
                f'name = "{kind} of {sender}"',
                f"systems = [{sender.system}]",
                f"components = [{sender.component}]",
                *_array(kind, values),
            ]
    return lines


def _array(name: str, values: set[int | str]) -> list[str]:
    """Return a sorted array, on one line if it fits."""
    texts = [f'"{value}"' if isinstance(value, str) else str(value) for value in sorted(values, key=str)]
    line = f"{name} = [{', '.join(texts)}]"
    return [line] if len(line) <= _WIDTH else [f"{name} = [", *(f"    {text}," for text in texts), "]"]
