"""The sender of setpoints to many vehicles at once, for a controller that computes all of them in one step.

A `SetpointStreamer` repeats one setpoint by its own timer, so a setpoint waits for the next tick. Here each
message is sent once, as soon as it was given; the controller repeats its step. On a full link it is dropped,
since the next step has a newer one.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

from mavstack.dialects import common
from mavstack.services.service import Outgoing, Priority, Service

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from mavstack.services.addressing import Address
    from mavstack.services.service import HasRoom

SetpointMessage: TypeAlias = common.SetPositionTargetGlobalInt | common.SetPositionTargetLocalNed


class SetpointBatch(Service):
    """The sender of the setpoints of one step.

    Args:
        local: The address of the local component.
    """

    def __init__(self, local: Address) -> None:
        super().__init__(local)
        self._pending: tuple[tuple[SetpointMessage, Address], ...] = ()

    def set(self, setpoints: Iterable[tuple[SetpointMessage, Address]]) -> None:
        """Send messages, each to its vehicle; those that were not sent yet are dropped."""
        self._pending = tuple(setpoints)

    def bulk_messages(self, now: float, has_room: HasRoom) -> Iterator[Outgoing]:
        # The link drops what it has no room for; a message that waited for room would be an old setpoint.
        pending, self._pending = self._pending, ()
        for message, target in pending:
            yield Outgoing(message, target, Priority.STREAM)
