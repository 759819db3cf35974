"""Who is on the network: components appear, fall silent, return, and reboot.

A component is found by its first HEARTBEAT, or by HIGH_LATENCY2, whose senders may never send the former.
What a vehicle is, its type says, not its component id. It is lost after `timeout` seconds without a sign of
life; other regular messages count as such, since on a bad link five heartbeats in a row are easily lost.

A reboot shows in `time_boot_ms`, which begins anew (see `RebootDetector`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.addressing import Address, message_ids
from mavstack.services.service import Event, Service, earliest
from mavstack.services.system_time import RebootDetector

if TYPE_CHECKING:
    from mavstack.wire import Packet

TIMEOUT = 5.0
#: HIGH_LATENCY2 comes every five seconds at best.
HIGH_LATENCY_TIMEOUT = 30.0
#: So many components are remembered; beyond it new ones are not, since real networks are far smaller.
MOST_COMPONENTS = 4096

_WITH_BOOT_TIME = (
    common.SystemTime,
    common.Attitude,
    common.AttitudeQuaternion,
    common.GlobalPositionInt,
    common.LocalPositionNed,
)


@dataclass(frozen=True, slots=True)
class ComponentInfo:
    """What a component said about itself; times in Unix seconds."""

    address: Address
    type: int
    autopilot: int
    base_mode: int
    custom_mode: int
    system_status: int
    first_seen: float
    last_seen: float
    high_latency: bool = False
    alive: bool = True

    @property
    def is_autopilot(self) -> bool:
        """Whether it flies or drives something: neither a payload nor a ground station."""
        return self.autopilot != common.MavAutopilot.INVALID and self.type not in _NOT_VEHICLES

    @property
    def armed(self) -> bool:
        """Whether its motors may run."""
        return bool(self.base_mode & common.MavModeFlag.SAFETY_ARMED)

    @property
    def timeout(self) -> float:
        """When it counts as lost, if it stays silent."""
        return HIGH_LATENCY_TIMEOUT if self.high_latency else TIMEOUT


_NOT_VEHICLES = frozenset(
    {
        common.MavType.GCS,
        common.MavType.ANTENNA_TRACKER,
        common.MavType.ONBOARD_CONTROLLER,
        common.MavType.GIMBAL,
        common.MavType.ADSB,
        common.MavType.CAMERA,
    }
)


@dataclass(frozen=True, slots=True)
class ComponentFound(Event):
    """A component was heard for the first time."""

    component: ComponentInfo


@dataclass(frozen=True, slots=True)
class ComponentLost(Event):
    """A component has been silent for too long."""

    component: ComponentInfo


@dataclass(frozen=True, slots=True)
class ComponentReturned(Event):
    """A lost component is heard again."""

    component: ComponentInfo


@dataclass(frozen=True, slots=True)
class ComponentRebooted(Event):
    """A component's boot time began anew: what was cached of it may be wrong."""

    component: ComponentInfo


class Discovery(Service):
    """The components that are or were heard, by address."""

    handles = message_ids(common.Heartbeat, common.HighLatency2, *_WITH_BOOT_TIME)

    def __init__(self, local: Address) -> None:
        super().__init__(local)
        self.components: dict[Address, ComponentInfo] = {}
        self._boot_times: dict[Address, RebootDetector] = {}
        self._look_at: float | None = (
            None  # no one is lost before; looking at all for each packet would be slow
        )

    def receive(self, packet: Packet, now: float) -> None:
        address = Address(packet.system, packet.component)
        match packet.message:
            case common.Heartbeat() as heartbeat:
                self._introduced(address, heartbeat, now)
            case common.HighLatency2() as summary:
                self._summarised(address, summary, now)
            case message:
                known = self.components.get(address)
                if known is not None:
                    self._take_in(replace(known, last_seen=now))
                    self._check_boot_time(address, message.time_boot_ms, now)

    def next_timeout(self) -> float | None:
        return self._look_at

    def handle_timeout(self, now: float) -> None:
        if self._look_at is None or now < self._look_at:
            return
        for address, info in self.components.items():
            if info.alive and now >= info.last_seen + info.timeout:
                self.components[address] = lost = replace(info, alive=False)
                self.tell(ComponentLost(lost))
        alive = (info for info in self.components.values() if info.alive)
        self._look_at = min((info.last_seen + info.timeout for info in alive), default=None)

    def _introduced(self, address: Address, heartbeat: common.Heartbeat, now: float) -> None:
        known = self.components.get(address)
        self._take_in(
            ComponentInfo(
                address,
                heartbeat.type,
                heartbeat.autopilot,
                heartbeat.base_mode,
                heartbeat.custom_mode,
                heartbeat.system_status,
                known.first_seen if known else now,
                now,
            )
        )

    def _summarised(self, address: Address, summary: common.HighLatency2, now: float) -> None:
        known = self.components.get(address)
        if known is not None and known.alive and not known.high_latency:
            self._take_in(replace(known, last_seen=now))
            return
        first_seen = known.first_seen if known else now
        self._take_in(
            ComponentInfo(
                address,
                summary.type,
                summary.autopilot,
                0,
                summary.custom_mode,
                common.MavState.UNINIT,
                first_seen,
                now,
                high_latency=True,
            )
        )

    def _take_in(self, info: ComponentInfo) -> None:
        known = self.components.get(info.address)
        if known is None:
            if len(self.components) >= MOST_COMPONENTS or 0 in info.address:
                return
            self.tell(ComponentFound(info))
        elif not known.alive:
            info = replace(info, alive=True)
            self.tell(ComponentReturned(info))
        self.components[info.address] = info
        self._look_at = earliest(self._look_at, info.last_seen + info.timeout)

    def _check_boot_time(self, address: Address, milliseconds: int, now: float) -> None:
        if self._boot_times.setdefault(address, RebootDetector()).observe(milliseconds, now):
            self.tell(ComponentRebooted(self.components[address]))
