"""Discovery: which components are on the network, and which were lost, returned or rebooted.

A component is found by its first HEARTBEAT, or by HIGH_LATENCY2, whose senders may never send the former. Its
type, not its component id, says whether it is a vehicle. It is lost after `ComponentInfo.timeout` seconds
without a sign of life; other regular messages count as such, since on a bad link five heartbeats in a row
are easily lost. A component to which no channel leads any more is lost at once.

Reboots and address conflicts are told apart as the package describes. A conflict is reported once, and
reboots of that address are not reported while it lasts. If a payload uses the address of a living autopilot,
the autopilot's heartbeats are the ones that count. A heartbeat with the local address that is no echo of the
local component's own is an `OwnAddressConflict`.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.addressing import Address, message_ids
from mavstack.services.heartbeat.address_conflict import AddressConflictDetector
from mavstack.services.heartbeat.admission import (
    MAX_COMPONENTS,
    NewComponentLimit,
    components_to_remove,
)
from mavstack.services.heartbeat.boot_time_filter import BootTimeFilter
from mavstack.services.heartbeat.boot_tracker import CONFLICT_ENDS_AFTER, Finding
from mavstack.services.heartbeat.component_info import HEARTBEAT_TIMEOUT, ComponentInfo
from mavstack.services.heartbeat.events import (
    AddressConflict,
    AddressConflictEnded,
    ComponentChanged,
    ComponentFound,
    ComponentLost,
    ComponentRebooted,
    ComponentReturned,
    OwnAddressConflict,
)
from mavstack.services.service import Service, earliest
from mavstack.services.version import AutopilotVersion

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from mavstack.wire import Packet

#: A table with more components is checked for lost ones once per this interval, in seconds, at most.
MANY_COMPONENTS = 300
MANY_INTERVAL = 0.5

_WITH_BOOT_TIME = (
    common.SystemTime,
    common.Attitude,
    common.AttitudeQuaternion,
    common.GlobalPositionInt,
    common.LocalPositionNed,
)
_BOOT_TIME_IDS = message_ids(*_WITH_BOOT_TIME)


class Discovery(Service):
    """The known components, by address.

    Args:
        local: The local component.
        is_echo: Returns True for a packet of the local component that came back over the network.
        channel_name: Returns the name of the channel of the packet that is being received.
        is_verified: Returns True for an address whose packets are verified by their signatures.
    """

    handles = message_ids(common.Heartbeat, common.HighLatency2, common.AutopilotVersion, *_WITH_BOOT_TIME)
    accepts_own_packets = True

    def __init__(
        self,
        local: Address,
        *,
        is_echo: Callable[[Packet], bool] = lambda packet: True,
        channel_name: Callable[[], str] = lambda: "",
        is_verified: Callable[[Address], bool] = lambda address: False,
    ) -> None:
        super().__init__(local)
        self.components: dict[Address, ComponentInfo] = {}
        self._is_echo, self._channel_name, self._is_verified = is_echo, channel_name, is_verified
        self._limit = NewComponentLimit()
        self._detectors: dict[Address, AddressConflictDetector] = {}
        self._filters: dict[tuple[int, int], BootTimeFilter] = {}  # of components that send boot times
        self._own_address_used_at: float | None = None
        self._check_at: float | None = None  # no component is lost before; a check per packet would be slow

    def has_conflict(self, address: Address) -> bool:
        """Return whether several senders use the address."""
        detector = self._detectors.get(address)
        return detector is not None and detector.in_conflict

    def unreachable(self, addresses: Iterable[Address], reason: str) -> None:
        """Mark components as lost because no channel leads to them any more."""
        for address in addresses:
            info = self.components.get(address)
            if info is not None and info.alive:
                self._lose(info, reason)

    def receive(self, packet: Packet, now: float) -> bool | None:
        boot_time_filter = self._filters.get((packet.system, packet.component))
        if (
            boot_time_filter
            and packet.message_id in _BOOT_TIME_IDS
            and boot_time_filter.is_expected(packet.message.time_boot_ms, now)
        ):
            return False
        self._analyse(packet, now)
        return None

    def _analyse(self, packet: Packet, now: float) -> None:
        address = Address(packet.system, packet.component)
        message = packet.message
        if address == self.local:
            if isinstance(message, common.Heartbeat) and not self._is_echo(packet):
                self._own_address_used(message, now)
            return
        match message:
            case common.Heartbeat() as heartbeat:
                self._heartbeat_received(address, heartbeat, now)
            case common.HighLatency2() as summary:
                self._high_latency_received(address, summary, now)
            case common.AutopilotVersion():
                if address in self.components:
                    self._version_received(address, AutopilotVersion.read(message), now)
            case _ if (known := self.components.get(address)) is not None:
                self._update(replace(known, last_seen=now), now - known.last_seen)
                boot_ms = message.time_boot_ms  # every other message in `handles` has it
                detector = self._detectors[address]
                self._report(address, detector.observe_boot_time(boot_ms, now, self._channel_name()), now)
                if detector.is_one_boot:
                    self._filters[address] = BootTimeFilter(boot_ms, now)
                else:
                    self._filters.pop(address, None)

    def next_timeout(self) -> float | None:
        return self._check_at

    def handle_timeout(self, now: float) -> None:
        if self._check_at is None or now < self._check_at:
            return
        for info in tuple(self.components.values()):
            boot_time_filter = self._filters.get(info.address)
            if boot_time_filter is not None and info.last_seen < boot_time_filter.seen_at:
                self.components[info.address] = replace(info, last_seen=boot_time_filter.seen_at)
        for info in tuple(self.components.values()):
            if info.alive and now >= info.last_seen + info.timeout:
                self._lose(info, f"silent for {info.timeout:g} s")
        alive = (info for info in self.components.values() if info.alive)
        self._check_at = min((info.last_seen + info.timeout for info in alive), default=None)
        if self._check_at is not None and len(self.components) > MANY_COMPONENTS:
            self._check_at = max(self._check_at, now + MANY_INTERVAL)  # a check visits all of them

    def _version_received(self, address: Address, version: AutopilotVersion, now: float) -> None:
        known = self.components[address]
        if known.identifier != version.identifier:
            self.components[address] = replace(known, identifier=version.identifier)
        finding = self._detectors[address].observe_unique_id(version.unique_id, now, self._channel_name())
        self._report(address, finding, now)

    def _heartbeat_received(self, address: Address, heartbeat: common.Heartbeat, now: float) -> None:
        known = self.components.get(address)
        info = ComponentInfo.from_heartbeat(address, heartbeat, now, known)
        if known is not None:
            if known.alive and self._is_payload_at_autopilot_address(known, info, now):
                info = replace(known, last_seen=now)
            self._update(info, now - known.last_seen)
        elif not self._add(info):
            return
        reported = int(heartbeat.type), int(heartbeat.autopilot)
        finding = self._detectors[address].observe_type(reported, now, self._channel_name())
        changed = known is not None and known.type_and_autopilot != info.type_and_autopilot
        if known is not None and changed and not self.has_conflict(address):
            self.emit(ComponentChanged(info, known))
        self._report(address, finding, now)

    def _is_payload_at_autopilot_address(self, known: ComponentInfo, info: ComponentInfo, now: float) -> bool:
        """Return whether a payload sends with the address of an autopilot that is alive."""
        seen_at = self._detectors[known.address].last_seen(known.type_and_autopilot)
        is_alive = known.is_autopilot and seen_at is not None and now - seen_at < HEARTBEAT_TIMEOUT
        return is_alive and not info.is_autopilot

    def _high_latency_received(self, address: Address, summary: common.HighLatency2, now: float) -> None:
        known = self.components.get(address)
        if known is not None and known.alive and not known.high_latency:
            self._update(replace(known, last_seen=now), now - known.last_seen)
            return
        info = ComponentInfo.from_high_latency(address, summary, now, known)
        if known is None:
            self._add(info)
        else:
            self._update(info, now - known.last_seen)

    def _add(self, info: ComponentInfo) -> bool:
        if 0 in info.address:
            return False
        is_verified = self._is_verified(info.address)
        if not is_verified and not self._limit.admits(self._channel_name(), info.last_seen):
            return False
        if len(self.components) >= MAX_COMPONENTS:
            for removed in components_to_remove(self.components.values(), self._is_verified):
                self._remove(removed)
        self.components[info.address] = info
        self._detectors[info.address] = AddressConflictDetector()
        self._check_at = earliest(self._check_at, info.last_seen + info.timeout)
        self.emit(ComponentFound(info))
        return True

    def _update(self, info: ComponentInfo, silence: float) -> None:
        if not self.components[info.address].alive:
            info = replace(info, alive=True)
            self.emit(ComponentReturned(info, silence))
        self.components[info.address] = info
        due = info.last_seen + info.timeout
        if self._check_at is None or due < self._check_at:
            self._check_at = due

    def _lose(self, info: ComponentInfo, reason: str) -> None:
        self._filters.pop(info.address, None)
        self.components[info.address] = lost = replace(info, alive=False)
        self.emit(ComponentLost(lost, reason))

    def _remove(self, info: ComponentInfo) -> None:
        """Forget a component to make room for another one."""
        if info.alive:
            self._lose(info, "too many components")
        for register in (self.components, self._detectors, self._filters):
            register.pop(info.address, None)

    def _report(self, address: Address, finding: Finding, now: float) -> None:
        match finding:
            case Finding.REBOOTED:
                self.emit(ComponentRebooted(self.components[address]))
            case Finding.CONFLICT:
                self.emit(AddressConflict(self.components[address], self._detectors[address].senders(now)))
            case Finding.CONFLICT_ENDED:
                self.emit(AddressConflictEnded(self.components[address]))

    def _own_address_used(self, heartbeat: common.Heartbeat, now: float) -> None:
        last = self._own_address_used_at
        if last is None or now - last > CONFLICT_ENDS_AFTER:
            self.emit(OwnAddressConflict(ComponentInfo.from_heartbeat(self.local, heartbeat, now)))
        self._own_address_used_at = now
