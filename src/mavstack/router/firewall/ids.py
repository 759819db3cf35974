"""System ids that are assigned to ground stations by their credentials.

MAVLink has no message that assigns an id, and a router never changes a packet. A station that joins with a
credential (the subject of a certificate, the name of a ticket, a key) gets an id of the pool: always the same
one for the same credential. Its packets pass when they have this id; an id of the pool that belongs to
another credential, or to none, is refused, and the station is told its own id. Ids outside the pool, those of
vehicles, are left to the rules.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.errors import InvalidStateError

if TYPE_CHECKING:
    from collections.abc import Mapping


class IdAssignment:
    """The assigned system ids of one router.

    Args:
        pool: The ids that are assigned.
        known: Assignments of an earlier run, by credential.
    """

    def __init__(self, pool: range, known: Mapping[str, int] | None = None) -> None:
        self._pool = pool
        owners: dict[int, str] = {}
        for credential, system in (known or {}).items():
            if system in pool:
                owners.setdefault(system, credential)
        self._ids = {credential: system for system, credential in owners.items()}

    @property
    def ids(self) -> dict[str, int]:
        """The assigned system id of each credential, to be kept for the next run."""
        return dict(self._ids)

    def assign(self, credential: str) -> int:
        """Return the id of a credential; a new one gets the lowest id that is free.

        Args:
            credential: The credential, which was verified.

        Returns:
            The system id.

        Raises:
            InvalidStateError: All ids of the pool belong to other credentials.
        """
        if credential not in self._ids:
            taken = set(self._ids.values())
            free = next((system for system in self._pool if system not in taken), None)
            if free is None:
                raise InvalidStateError(
                    f"all {len(self._pool)} system ids of the pool are assigned: enlarge it"
                )
            self._ids[credential] = free
        return self._ids[credential]

    def release(self, credential: str) -> None:
        """Give the id of a credential back. Idempotent.

        Args:
            credential: The credential.
        """
        self._ids.pop(credential, None)

    def refusal(self, credential: str, system: int) -> str | None:
        """Return the reason why a sender may not use a system id.

        Args:
            credential: The credential of the link that the packet came over; empty: none.
            system: The system id of the packet.

        Returns:
            The reason; None if it may.
        """
        own = self._ids.get(credential) if credential else None
        if system == own or system not in self._pool:
            return None
        hint = f"; this station has id {own}" if own is not None else "; it needs a credential"
        return f"id {system} is not its own{hint}"
