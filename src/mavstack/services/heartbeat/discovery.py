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
from functools import partial
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.addressing import Address, message_ids
from mavstack.services.heartbeat.address_conflict import AddressConflictDetector
from mavstack.services.heartbeat.admission import MAX_COMPONENTS, NewComponentLimit, components_to_remove
from mavstack.services.heartbeat.boot_time_filter import BootTimeFilters
from mavstack.services.heartbeat.boot_tracker import CONFLICT_ENDS_AFTER, MAX_PATH_DELAY, Finding
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
from mavstack.services.heartbeat.sender_probe import SenderProbes
from mavstack.services.service import HasRoom, Outgoing, Service, always_room, earliest
from mavstack.services.version import AutopilotVersion

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from mavstack.dialects import Message
    from mavstack.services.heartbeat.boot_time_filter import Key
    from mavstack.services.heartbeat.conflicting_sender import Conflict
    from mavstack.wire import Packet

#: The number of components above which the table is checked for lost ones only every `MANY_INTERVAL` seconds.
MANY_COMPONENTS = 300
MANY_INTERVAL = 0.5
#: Seconds for which an address that arrives on another channel too is examined for a conflict.
EXAMINATION_TIME = 3.0

_WITH_BOOT_TIME = (
    common.SystemTime,
    common.Attitude,
    common.AttitudeQuaternion,
    common.GlobalPositionInt,
    common.LocalPositionNed,
)
#: The messages whose expected boot times need no analysis. GLOBAL_POSITION_INT is always analysed: each
#: position is compared with earlier ones.
_FILTERED_IDS = message_ids(*_WITH_BOOT_TIME) - message_ids(common.GlobalPositionInt)


class Discovery(Service):
    """The known components, by address.

    Args:
        local: The local component.
        is_echo: Returns True for a packet of the local component that came back over the network.
        channel_name: Returns the name of the channel of the packet that is being received.
        is_verified: Returns True for an address whose packets are verified by their signatures.
        is_excluded: Returns True for a system for which another channel was chosen than the packet's.
        asks: Ask an autopilot that is heard on several channels for its unique id and its time on each.
    """

    handles = message_ids(
        common.Heartbeat, common.HighLatency2, common.AutopilotVersion, common.Timesync, *_WITH_BOOT_TIME
    )
    accepts_own_packets = True
    observes_all_senders = True

    def __init__(
        self,
        local: Address,
        *,
        is_echo: Callable[[Packet], bool] = lambda packet: True,
        channel_name: Callable[[], str] = lambda: "",
        is_verified: Callable[[Address], bool] = lambda address: False,
        is_excluded: Callable[[int], bool] = lambda system: False,
        asks: bool = False,
    ) -> None:
        super().__init__(local)
        self.components: dict[Address, ComponentInfo] = {}
        self._is_echo, self._channel_name, self._is_verified = is_echo, channel_name, is_verified
        self._is_excluded = is_excluded
        self._limit = NewComponentLimit()
        self._detectors: dict[Address, AddressConflictDetector] = {}
        #: The filters of components that send boot times.
        self.filters = BootTimeFilters()
        self._probes = SenderProbes(asks)
        #: The autopilots whose address several vehicles use, by system id.
        self.conflicts: dict[int, Address] = {}
        self._now = 0.0
        self._own_address_used_at: float | None = None
        # no component can be lost before this time; a check for each packet would be slow
        self._check_at: float | None = None

    def has_conflict(self, address: Address) -> bool:
        """Return whether several senders use the address."""
        detector = self._detectors.get(address)
        return detector is not None and detector.in_conflict

    def conflict(self, address: Address, now: float) -> Conflict | None:
        """Return the senders that use the address and what tells them apart; None without a conflict."""
        detector = self._detectors.get(address)
        return None if detector is None else detector.conflict(now)

    def vehicle_conflict(self, system: int) -> Conflict | None:
        """Return the vehicles that use a system id; None if no more than one does."""
        address = self.conflicts.get(system)
        return None if address is None else self.conflict(address, self._now)

    def autopilot_of(self, system: int) -> Address | None:
        """Return the address of the autopilot of a system; None without one."""
        found = (info for info in self.components.values() if info.address.system == system)
        return next((info.address for info in found if info.is_autopilot), None)

    def is_examined(self, address: Address, now: float) -> bool:
        """Return whether it is known, or will not be known soon, that one sender uses the address.

        An address that came on another channel is being examined until its unique ids were received there,
        for `EXAMINATION_TIME` seconds at most.
        """
        detector = self._detectors.get(address)
        if detector is None or detector.in_conflict or len(detector.channels(now)) < 2:
            return True
        is_one = detector.is_one_board(now) or self._probes.are_linked(address, detector.channels(now))
        return is_one or now - detector.joined_at(now) >= EXAMINATION_TIME

    def forget_channel(self, channel: str, now: float, address: Address | None = None) -> None:
        """Forget what was received on a channel that was closed, or whose vehicle left the address."""
        for known in tuple(self._detectors) if address is None else (address,):
            self._probes.remove_channel(known, channel)
            if (detector := self._detectors.get(known)) is not None:
                self._report(known, detector.forget_channel(channel, now), now)

    def messages_to_send(self, now: float, has_room: HasRoom = always_room) -> Iterator[Outgoing]:
        yield from self._probes.questions(now)
        yield from super().messages_to_send(now, has_room)

    def unreachable(self, addresses: Iterable[Address], reason: str) -> None:
        """Mark components as lost because no channel leads to them any more."""
        for address in addresses:
            info = self.components.get(address)
            if info is not None and info.alive:
                self._lose(info, reason)

    def receive(self, packet: Packet, now: float) -> bool | None:
        if packet.message_id in _FILTERED_IDS:
            key = packet.system, packet.component, self._channel_name()
            if self.filters.is_expected(key, packet.message.time_boot_ms, now):
                return False
        self._analyse(packet, now)
        return None

    def _analyse(self, packet: Packet, now: float) -> None:
        self._now = now
        address = Address(packet.system, packet.component)
        message = packet.message
        if address == self.local:
            if isinstance(message, common.Heartbeat) and not self._is_echo(packet):
                self._own_address_used(message, now)
            return
        if self._is_excluded(address.system):
            self._observe_excluded(address, message, now)
            return
        match message:
            case common.Heartbeat() as heartbeat:
                self._heartbeat_received(address, heartbeat, now)
            case common.HighLatency2() as summary:
                self._high_latency_received(address, summary, now)
            case common.AutopilotVersion():
                if address in self.components:
                    self._version_received(address, AutopilotVersion.read(message), now)
            case common.Timesync():
                self._probes.time_received(address, message, now, self._channel_name())
            case _ if (known := self.components.get(address)) is not None:
                self._update(replace(known, last_seen=now), now - known.last_seen)
                self._boot_time_received(address, message, message.time_boot_ms, now)

    def _observe_excluded(self, address: Address, message: Message, now: float) -> None:
        """Look for contradictions in a packet of a sender that was not chosen; its state does not count."""
        detector, channel = self._detectors.get(address), self._channel_name()
        match message:
            case _ if detector is None:
                return
            case common.Heartbeat(type=kind, autopilot=autopilot):
                finding = detector.observe_type((int(kind), int(autopilot)), now, channel)
            case common.AutopilotVersion():
                finding = self._observe_version(address, AutopilotVersion.read(message), now)
            case common.HighLatency2():
                return
            case common.Timesync():
                self._probes.time_received(address, message, now, channel)
                return
            case _:
                finding = detector.observe_message(message, message.time_boot_ms, now, channel)  # type: ignore[attr-defined]
        if finding is not Finding.REBOOTED:
            self._report(address, finding, now)

    def _observe_version(self, address: Address, version: AutopilotVersion, now: float) -> Finding:
        channel = self._channel_name()
        if version.unique_id:
            self._probes.answered(address, channel, now)
        return self._detectors[address].observe_version(version, now, channel)

    def note_boot(self, key: Key, boot_ms: int, seen_at: float) -> None:
        """Record the last message of a sender that another filter let pass.

        Args:
            key: The sender.
            boot_ms: The boot time of the message in milliseconds.
            seen_at: Unix time of its arrival in seconds.
        """
        self.filters.note_seen(key, seen_at)
        system, component, channel = key
        if (detector := self._detectors.get(Address(system, component))) is not None:
            detector.note_expected(boot_ms, seen_at, channel)

    def _boot_time_received(self, address: Address, message: Message, boot_ms: int, now: float) -> None:
        """Check a message with a boot time: every other message in `handles` has one."""
        detector, channel = self._detectors[address], self._channel_name()
        key = (*address, channel)
        if (last := self.filters.last_boot(key)) is not None:
            self.note_boot(key, *last)
        self._report(address, detector.observe_message(message, boot_ms, now, channel), now)
        self._update_probe(address, now)
        if detector.is_one_boot:
            self.filters.set(key, boot_ms, now)
        else:
            self.filters.remove(key)

    def _update_probe(self, address: Address, now: float) -> None:
        """Ask on each channel of an autopilot that is heard on several, or that may be two."""
        if self.components[address].is_autopilot:
            detector = self._detectors[address]
            self._probes.update(address, detector.channels(now), now, is_suspect=detector.is_suspect())

    def next_timeout(self) -> float | None:
        return earliest(self._check_at, self._probes.next_timeout())

    def handle_timeout(self, now: float) -> None:
        if self._check_at is None or now < self._check_at:
            return
        # The filtered packets of hundreds of vehicles are noted only when they may keep one of them alive.
        if self._silent(now):
            self._note_filtered()
            for info in self._silent(now):
                self._lose(info, f"silent for {info.timeout:g} s")
        alive = (info for info in self.components.values() if info.alive)
        self._check_at = min((info.last_seen + info.timeout for info in alive), default=None)
        if self._check_at is not None and len(self.components) > MANY_COMPONENTS:
            self._check_at = max(self._check_at, now + MANY_INTERVAL)  # each check visits all components

    def _silent(self, now: float) -> list[ComponentInfo]:
        """Return the components that are alive, of which nothing was noted for their timeout."""
        known = self.components.values()
        return [info for info in known if info.alive and now >= info.last_seen + info.timeout]

    def _note_filtered(self) -> None:
        """Note the arrival of the packets that were not analysed."""
        for system, component, seen_at in self.filters.last_seen():
            info = self.components[Address(system, component)]
            if info.last_seen < seen_at:
                self.components[info.address] = replace(info, last_seen=seen_at)

    def _version_received(self, address: Address, version: AutopilotVersion, now: float) -> None:
        known = self.components[address]
        if known.identifier != version.identifier:
            self.components[address] = replace(known, identifier=version.identifier)
        self._report(address, self._observe_version(address, version, now), now)

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
        self._update_probe(address, now)

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
        self._detectors[info.address] = AddressConflictDetector(
            partial(self._probes.round_trip, info.address, unknown=MAX_PATH_DELAY)
        )
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
        self.filters.remove_address(info.address)
        self.components[info.address] = lost = replace(info, alive=False)
        self.emit(ComponentLost(lost, reason))

    def _remove(self, info: ComponentInfo) -> None:
        """Forget a component to make room for another one."""
        if info.alive:
            self._lose(info, "too many components")
        self._probes.remove(info.address)
        self._forget_conflict(info.address)
        self.filters.remove_address(info.address)
        del self.components[info.address], self._detectors[info.address]

    def _forget_conflict(self, address: Address) -> None:
        if self.conflicts.get(address.system) == address:
            del self.conflicts[address.system]

    def _report(self, address: Address, finding: Finding, now: float) -> None:
        match finding:
            case Finding.REBOOTED:
                self.emit(ComponentRebooted(self.components[address]))
            case Finding.CONFLICT:
                if (conflict := self.conflict(address, now)) is not None:
                    self.filters.remove_address(address)
                    if self.components[address].is_autopilot and conflict.is_between_vehicles:
                        self.conflicts[address.system] = address
                    self.emit(AddressConflict(self.components[address], conflict.senders, conflict.differs))
            case Finding.CONFLICT_ENDED:
                self._forget_conflict(address)
                self.emit(AddressConflictEnded(self.components[address]))

    def _own_address_used(self, heartbeat: common.Heartbeat, now: float) -> None:
        last = self._own_address_used_at
        if last is None or now - last > CONFLICT_ENDS_AFTER:
            self.emit(OwnAddressConflict(ComponentInfo.from_heartbeat(self.local, heartbeat, now)))
        self._own_address_used_at = now
