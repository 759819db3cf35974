"""The events of `Discovery`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from mavstack.services.service import Event

if TYPE_CHECKING:
    from mavstack.services.heartbeat.component_info import ComponentInfo
    from mavstack.services.heartbeat.conflicting_sender import ConflictingSender


@dataclass(frozen=True, slots=True)
class ComponentFound(Event):
    """A component was found."""

    component: ComponentInfo


@dataclass(frozen=True, slots=True)
class ComponentLost(Event):
    """A component was silent for too long, or no channel leads to it; `reason` says which."""

    component: ComponentInfo
    reason: str


@dataclass(frozen=True, slots=True)
class ComponentReturned(Event):
    """A lost component returned, `after` seconds after its last sign of life."""

    component: ComponentInfo
    after: float


@dataclass(frozen=True, slots=True)
class ComponentChanged(Event):
    """A component reports another type or autopilot than before."""

    component: ComponentInfo
    before: ComponentInfo


@dataclass(frozen=True, slots=True)
class ComponentRebooted(Event):
    """The boot time of a component restarted: state cached of it may be wrong."""

    component: ComponentInfo


@dataclass(frozen=True, slots=True)
class AddressConflict(Event):
    """Several senders use one address; emitted once until it is over."""

    component: ComponentInfo
    senders: tuple[ConflictingSender, ...]
    differs: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class AddressConflictEnded(Event):
    """Only one sender has used an address for a while."""

    component: ComponentInfo


@dataclass(frozen=True, slots=True)
class OwnAddressConflict(Event):
    """Another sender uses the local address; emitted once until it has been silent for a while."""

    component: ComponentInfo
