"""The senders that a node listens to and speaks to: which one was chosen where several use one system id.

Until one is chosen, a message that acts is refused, since any of the vehicles could act. After the choice
the packets of that system count only on the chosen channel, and packets to it go over that channel alone. A
choice ends with its channel.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.errors import InvalidArgumentError, SystemIdConflictError
from mavstack.security.acting import acts

if TYPE_CHECKING:
    from collections.abc import Callable, Container, Sequence

    from mavstack.dialects import Message
    from mavstack.node.channel_state import ChannelState
    from mavstack.services import Address
    from mavstack.services.heartbeat import Conflict


def is_named(channel: str, text: str) -> bool:
    """Return whether a text is the name of a channel, or the remote address in it."""
    return channel == text or channel.partition(" ")[2] == text


class ChosenSenders:
    """The choices of one engine.

    Args:
        channels: The open channels.
    """

    def __init__(self, channels: Sequence[ChannelState]) -> None:
        self._channels = channels
        self._chosen: dict[int, str] = {}
        self._only: str | None = None
        #: Called before the chosen sender of a system id or the only allowed channel changes.
        self.before_change: Callable[[], None] = lambda: None
        #: The system ids that several vehicles use.
        self.systems: Container[int] = ()
        #: Returns the vehicles that use a system id; None if at most one vehicle uses it.
        self.conflict_of: Callable[[int], Conflict | None] = lambda system: None

    @property
    def is_limited(self) -> bool:
        """True if packets of some channels do not count."""
        return bool(self._chosen) or self._only is not None

    def limit_to(self, text: str | None) -> None:
        """Take only packets of this channel, and send to vehicles over it alone; None: of all channels."""
        self.before_change()
        self._only = text

    def choose(self, system: int, text: str | None) -> str | None:
        """Choose the channel of a system by its name or its remote address; None takes the choice back.

        Returns:
            The name of the channel.

        Raises:
            InvalidArgumentError: No open channel is named so, or several senders are received over it.
        """
        self.before_change()
        if text is None:
            self._chosen.pop(system, None)
            return None
        names = [channel.name for channel in self._channels if is_named(channel.name, text)]
        operation = f"choosing the sender of system id {system} failed"
        if len(names) != 1:
            known = ", ".join(channel.name for channel in self._channels) or "none"
            reason = "several channels are" if names else "no open channel is"
            raise InvalidArgumentError(f"{operation}: {reason} named {text!r}; open channels: {known}")
        conflict = self.conflict_of(system)
        if conflict is not None and not conflict.is_separate(names[0]):
            raise InvalidArgumentError(
                f"{operation}: {names[0]} brings none of the senders, or several: {conflict}; "
                "connect to one of them directly, or switch the others off"
            )
        self._chosen[system] = names[0]
        return names[0]

    def chosen(self, system: int) -> str | None:
        """Return the name of the channel that was chosen for a system, if one was."""
        if (name := self._chosen.get(system)) is not None:
            return name
        return next(iter(self._limit()), None) if self._only is not None else None

    def excludes(self, system: int, channel: ChannelState) -> bool:
        """Return whether packets of a system do not count on a channel."""
        if (name := self._chosen.get(system)) is not None:
            return channel.name != name
        return self._only is not None and not is_named(channel.name, self._only)

    def channels_to(self, target: Address) -> Sequence[ChannelState] | None:
        """Return the channels to which a choice limits packets for a target; None: it limits none."""
        if target.system and (name := self._chosen.get(target.system)) is not None:
            return [channel for channel in self._channels if channel.name == name]
        if target.system and self._only is not None:
            return [channel for channel in self._channels if is_named(channel.name, self._only)]
        return None

    def channel_closed(self, channel: ChannelState) -> None:
        """Take back the choices of a channel that was closed."""
        self._chosen = {system: name for system, name in self._chosen.items() if name != channel.name}

    def refusal(self, message: Message, target: Address, operation: str = "") -> SystemIdConflictError | None:
        """Return why a message may not be sent to a target now; None if it may."""
        if target.system not in self.systems or not acts(message):
            return None
        name = type(message).__mavlink_row__[1]
        return self.refusal_of(target, operation or f"sending {name} to")

    def refusal_of(self, target: Address, operation: str) -> SystemIdConflictError | None:
        """Return why an operation may not act on a target now; None if it may."""
        conflict = self.conflict_of(target.system) if target.system in self.systems else None
        if conflict is None:
            return None
        chosen = self.chosen(target.system)
        if chosen is not None and conflict.is_separate(chosen):
            return None
        return SystemIdConflictError(operation, str(target), answer=_answer(target.system, conflict))

    def unmet_limit(self) -> str:
        """Return an error text if only packets of one channel count, and that channel is not open."""
        if self._only is None or self._limit():
            return ""
        known = ", ".join(channel.name for channel in self._channels) or "none"
        return f"no open channel is named {self._only!r}; open channels: {known}"

    def _limit(self) -> list[str]:
        return [channel.name for channel in self._channels if is_named(channel.name, self._only or "")]


def _answer(system: int, conflict: Conflict) -> str:
    """Return the reason of a refusal, with the senders and the remedy."""
    names = [name for sender in conflict.senders for name in sender.channels if conflict.is_separate(name)]
    if names:
        name = names[0].partition(" ")[2] or names[0]
        remedy = f"choose one by its channel: --channel {name}, or choose_sender({name!r})"
    else:
        remedy = "connect to one of them directly, or switch the others off"
    return f"{len(conflict.senders)} vehicles use system id {system}: {conflict}; {remedy}"
