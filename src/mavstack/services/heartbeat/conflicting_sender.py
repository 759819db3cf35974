"""The facts about several senders that use one address."""

from __future__ import annotations

from dataclasses import dataclass

from mavstack.services.heartbeat.component_types import describe_component, is_vehicle


@dataclass(frozen=True, slots=True)
class ConflictingSender:
    """One of several senders that use an address.

    Attributes:
        type_and_autopilot: Its MAV_TYPE and MAV_AUTOPILOT, if it sent a HEARTBEAT.
        booted_at: When it booted, Unix seconds, if its boot time is known.
        unique_id: Its unique id in hexadecimal; empty if it is not known.
        channels: The names of the channels over which it was received.
        position: Its latitude and longitude in degrees; None if its position is not known.
    """

    type_and_autopilot: tuple[int, int] | None = None
    booted_at: float | None = None
    unique_id: str = ""
    channels: tuple[str, ...] = ()
    position: tuple[float, float] | None = None

    @property
    def remotes(self) -> tuple[str, ...]:
        """The remote addresses of the channels: "127.0.0.1:14550", "/dev/ttyACM0"."""
        return tuple(channel.partition(" ")[2] or channel for channel in self.channels)

    def __str__(self) -> str:
        known = self.type_and_autopilot
        words = [describe_component(*known) if known else "unknown component"]
        if self.unique_id:
            words.append(f"with the id {self.unique_id}")
        if self.position is not None:
            words.append(f"at {self.position[0]:.6f}, {self.position[1]:.6f}")
        if self.channels:
            words.append(f"on {', '.join(self.channels)}")
        return " ".join(words)


@dataclass(frozen=True, slots=True)
class Conflict:
    """Several senders that use one address.

    Attributes:
        senders: The senders, two or more.
        differs: What tells them apart, such as "unique id", "boot time", "position", "heading" or "type".
    """

    senders: tuple[ConflictingSender, ...]
    differs: tuple[str, ...]

    def is_separate(self, channel: str) -> bool:
        """Return whether exactly one of the senders is received over a channel."""
        return sum(channel in sender.channels for sender in self.senders) == 1

    @property
    def is_between_vehicles(self) -> bool:
        """False if all senders but one are known to be payloads with the address of an autopilot."""
        known = [each.type_and_autopilot for each in self.senders]
        return sum(each is None or is_vehicle(*each) for each in known) > 1

    def __str__(self) -> str:
        return f"{'; '.join(map(str, self.senders))} (different: {', '.join(self.differs)})"
