"""Rules: which packets an endpoint of the router lets through, in each direction.

    RuleSet(incoming=(Rule("drop", commands=frozenset({400}), name="no arming"),))

The rules of a direction are tried in order, and the first whose conditions all hold decides; if none does,
the default of the direction decides. The engine compares a packet only with rules that name its message or no
message, so that many rules for commands cost telemetry nothing.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

from mavstack.errors import InvalidArgumentError

#: The effect of a rule on a packet: forward it, drop it, or let the program decide.
Action: TypeAlias = Literal["pass", "drop", "inspect"]

ACTIONS: tuple[Action, ...] = ("pass", "drop", "inspect")
MAX_MESSAGE_ID = (1 << 24) - 1
MAX_COMMAND = (1 << 16) - 1
MAX_ID = 255


@dataclass(frozen=True, slots=True)
class Rule:
    """Conditions on a packet, which must all hold, and an action. An empty condition always holds.

    Args:
        action: What happens: `"pass"`, `"drop"`, or `"inspect"` for a decision of the program.
        messages: Message ids.
        systems: System ids of the source.
        components: Component ids of the source.
        target_systems: System ids of the target; 0 is that of packets without a target.
        commands: Commands (MAV_CMD); only COMMAND_LONG and COMMAND_INT with one of them match.
        rate: Packets per second that the rule lets pass, with bursts of one second; more are dropped. None:
            all.
        name: The name in statistics and events.
        dry_run: Only count and tell what the rule would drop; the next rule decides.

    Raises:
        InvalidArgumentError: An id, the action or the rate is out of its range.
    """

    action: Action
    messages: frozenset[int] = frozenset()
    systems: frozenset[int] = frozenset()
    components: frozenset[int] = frozenset()
    target_systems: frozenset[int] = frozenset()
    commands: frozenset[int] = frozenset()
    rate: float | None = None
    name: str = ""
    dry_run: bool = False

    def __post_init__(self) -> None:
        """Check all values."""
        _check_action("action", self.action)
        _check_range("messages", self.messages, MAX_MESSAGE_ID)
        _check_range("systems", self.systems, MAX_ID)
        _check_range("components", self.components, MAX_ID)
        _check_range("target_systems", self.target_systems, MAX_ID)
        _check_range("commands", self.commands, MAX_COMMAND)
        _check_rate("rate", self.rate)


@dataclass(frozen=True, slots=True)
class RuleSet:
    """The rules of one endpoint.

    Args:
        incoming: Rules for packets that come from the endpoint.
        outgoing: Rules for packets that go to it.
        default_incoming: What happens to packets from it for which no rule decides.
        default_outgoing: What happens to packets to it for which no rule decides.
        bytes_per_second: Bytes that go to the endpoint per second; a quarter of a second may go at once, and
            a quarter of that is kept for heartbeats and packets with a target. None: no limit.

    Raises:
        InvalidArgumentError: A default or the byte rate is invalid.
    """

    incoming: tuple[Rule, ...] = ()
    outgoing: tuple[Rule, ...] = ()
    default_incoming: Action = "pass"
    default_outgoing: Action = "pass"
    bytes_per_second: float | None = None

    def __post_init__(self) -> None:
        """Check all values."""
        _check_action("default_incoming", self.default_incoming)
        _check_action("default_outgoing", self.default_outgoing)
        _check_rate("bytes_per_second", self.bytes_per_second)


def _check_action(name: str, action: str) -> None:
    if action not in ACTIONS:
        raise InvalidArgumentError(f"{name} must be one of {', '.join(ACTIONS)}, got {action!r}")


def _check_range(name: str, ids: frozenset[int], maximum: int) -> None:
    for wrong in (number for number in ids if not 0 <= number <= maximum):
        raise InvalidArgumentError(f"{name} must be 0 to {maximum}, got {wrong}")


def _check_rate(name: str, rate: float | None) -> None:
    if rate is not None and not 0 < rate < float("inf"):
        raise InvalidArgumentError(f"{name} must be positive and finite, or None, got {rate}")
