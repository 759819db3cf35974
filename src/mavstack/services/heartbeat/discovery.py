"""Who is on the network: components appear, fall silent, return, and reboot.

A component is found by its first HEARTBEAT, or by HIGH_LATENCY2, whose senders may never send the former.
What a vehicle is, its type says, not its component id. It is lost after `timeout` seconds without a sign of
life; other regular messages count as such, since on a bad link five heartbeats in a row are easily lost. Who
was heard only over channels that are gone is lost at once.

A reboot shows in the time since boot, and so do two senders that use one address (see `lives` and `claims`):
that is told once, and reboots of that address are not told while it lasts. If a payload calls itself by a
living autopilot's address, the autopilot's heartbeats are those that count. Who uses our own address is told
of too, by those of its heartbeats that are no echo of ours.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.addressing import Address, message_ids
from mavstack.services.heartbeat.claims import Claim, Claims
from mavstack.services.heartbeat.kinds import describe_kind
from mavstack.services.heartbeat.lives import OVER, Verdict
from mavstack.services.heartbeat.pulse import Pulse
from mavstack.services.service import Event, Service, earliest
from mavstack.services.version import AutopilotVersion

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

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
_BOOT_TIME_IDS = message_ids(*_WITH_BOOT_TIME)


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
        return _flies(self.type, self.autopilot)

    @property
    def is_ground_station(self) -> bool:
        """Whether people sit there."""
        return self.type == common.MavType.GCS

    @property
    def kind(self) -> str:
        """What it is, in words: "camera", "quadrotor with PX4"."""
        return describe_kind(self.type, self.autopilot)

    @property
    def armed(self) -> bool:
        """Whether its motors may run."""
        return bool(self.base_mode & common.MavModeFlag.SAFETY_ARMED)

    @property
    def timeout(self) -> float:
        """When it counts as lost, if it stays silent."""
        return HIGH_LATENCY_TIMEOUT if self.high_latency else TIMEOUT


_Type = common.MavType
_NOT_VEHICLES = frozenset(
    {
        _Type.GCS,
        _Type.ANTENNA_TRACKER,
        _Type.ONBOARD_CONTROLLER,
        _Type.GIMBAL,
        _Type.ADSB,
        _Type.CAMERA,
        _Type.CHARGING_STATION,
        _Type.FLARM,
        _Type.SERVO,
        _Type.ODID,
        _Type.BATTERY,
        _Type.PARACHUTE,
        _Type.LOG,
        _Type.OSD,
        _Type.IMU,
        _Type.GPS,
        _Type.WINCH,
        _Type.ILLUMINATOR,
        _Type.GRIPPER,
        _Type.RADIO,
    }
)


def _flies(type_number: int, autopilot: int) -> bool:
    return autopilot != common.MavAutopilot.INVALID and type_number not in _NOT_VEHICLES


@dataclass(frozen=True, slots=True)
class ComponentFound(Event):
    """A component was heard for the first time."""

    component: ComponentInfo


@dataclass(frozen=True, slots=True)
class ComponentLost(Event):
    """A component has been silent for too long, or cannot be reached any more; `reason` says which."""

    component: ComponentInfo
    reason: str


@dataclass(frozen=True, slots=True)
class ComponentReturned(Event):
    """A lost component is heard again, so many seconds after it was heard last."""

    component: ComponentInfo
    after: float


@dataclass(frozen=True, slots=True)
class ComponentChanged(Event):
    """A component says that it is of another type, or has another autopilot, than before."""

    component: ComponentInfo
    before: ComponentInfo


@dataclass(frozen=True, slots=True)
class ComponentRebooted(Event):
    """A component's boot time began anew: what was cached of it may be wrong."""

    component: ComponentInfo


@dataclass(frozen=True, slots=True)
class AddressClash(Event):
    """Two components use one address; told once until it is over."""

    component: ComponentInfo
    claims: tuple[Claim, ...]


@dataclass(frozen=True, slots=True)
class AddressClashOver(Event):
    """Only one component has used an address for a while."""

    component: ComponentInfo


@dataclass(frozen=True, slots=True)
class OwnAddressConflict(Event):
    """Someone else uses our own address; told once until it has been silent for a while."""

    component: ComponentInfo


class Discovery(Service):
    """The components that are or were heard, by address.

    `is_echo` tells a heartbeat of our own that came back from one of someone else with our address; `where`
    names the channel of the packet that is being received.
    """

    handles = message_ids(common.Heartbeat, common.HighLatency2, common.AutopilotVersion, *_WITH_BOOT_TIME)
    accepts_own_packets = True

    def __init__(
        self,
        local: Address,
        *,
        is_echo: Callable[[Packet], bool] = lambda packet: True,
        where: Callable[[], str] = lambda: "",
    ) -> None:
        super().__init__(local)
        self.components: dict[Address, ComponentInfo] = {}
        self._is_echo, self._where = is_echo, where
        self._claims: dict[Address, Claims] = {}
        self._pulses: dict[tuple[int, int], Pulse] = {}  # of those alive who tell their time since boot
        self._taken_at: float | None = None  # when our own address was last used by someone else
        self._look_at: float | None = (
            None  # no one is lost before; looking at all for each packet would be slow
        )

    def clash_of(self, address: Address) -> bool:
        """Whether several components use the address."""
        claims = self._claims.get(address)
        return claims is not None and claims.clashing

    def unreachable(self, addresses: Iterable[Address], reason: str) -> None:
        """No channel leads to these any more."""
        for address in addresses:
            info = self.components.get(address)
            if info is not None and info.alive:
                self._lose(info, reason)

    def receive(self, packet: Packet, now: float) -> bool | None:
        pulse = self._pulses.get((packet.system, packet.component))
        if pulse and packet.message_id in _BOOT_TIME_IDS and pulse.goes_on(packet.message.time_boot_ms, now):
            return False
        self._look_closely(packet, now)
        return None

    def _look_closely(self, packet: Packet, now: float) -> None:
        address = Address(packet.system, packet.component)
        message = packet.message
        if address == self.local:
            if isinstance(message, common.Heartbeat) and not self._is_echo(packet):
                self._is_taken(message, now)
            return
        match message:
            case common.Heartbeat() as heartbeat:
                self._introduced(address, heartbeat, now)
            case common.HighLatency2() as summary:
                self._summarised(address, summary, now)
            case common.AutopilotVersion():
                if address in self.components:
                    unique_id = AutopilotVersion.read(message).unique_id
                    self._judge(address, self._claims[address].unique_id(unique_id, now, self._where()), now)
            case _ if (known := self.components.get(address)) is not None:
                self._take_in(replace(known, last_seen=now), now - known.last_seen)
                boot_ms = message.time_boot_ms  # the others have it
                claims = self._claims[address]
                self._judge(address, claims.boot_time(boot_ms, now, self._where()), now)
                if claims.undisputed:
                    self._pulses[address] = Pulse(boot_ms, now)
                else:
                    self._pulses.pop(address, None)

    def next_timeout(self) -> float | None:
        return self._look_at

    def handle_timeout(self, now: float) -> None:
        if self._look_at is None or now < self._look_at:
            return
        for info in tuple(self.components.values()):
            pulse = self._pulses.get(info.address)
            if pulse is not None and info.last_seen < pulse.heard_at:
                self.components[info.address] = replace(info, last_seen=pulse.heard_at)
        for info in tuple(self.components.values()):
            if info.alive and now >= info.last_seen + info.timeout:
                self._lose(info, f"silent for {info.timeout:g} s")
        alive = (info for info in self.components.values() if info.alive)
        self._look_at = min((info.last_seen + info.timeout for info in alive), default=None)

    def _introduced(self, address: Address, heartbeat: common.Heartbeat, now: float) -> None:
        known = self.components.get(address)
        info = _introduction(address, heartbeat, now, known)
        if known is not None:
            if known.alive and self._is_usurped(known, info, now):
                info = replace(known, last_seen=now)
            self._take_in(info, now - known.last_seen)
        elif not self._found(info):
            return
        kind = int(heartbeat.type), int(heartbeat.autopilot)
        verdict = self._claims[address].kind(kind, now, self._where())
        if known is not None and _kind(known) != _kind(info) and not self.clash_of(address):
            self.emit(ComponentChanged(info, known))
        self._judge(address, verdict, now)

    def _is_usurped(self, known: ComponentInfo, info: ComponentInfo, now: float) -> bool:
        """Whether a payload calls itself by the address of an autopilot that is alive."""
        heard_at = self._claims[known.address].heard_as(_kind(known))
        is_there = known.is_autopilot and heard_at is not None and now - heard_at < TIMEOUT
        return is_there and not info.is_autopilot

    def _summarised(self, address: Address, summary: common.HighLatency2, now: float) -> None:
        known = self.components.get(address)
        if known is not None and known.alive and not known.high_latency:
            self._take_in(replace(known, last_seen=now), now - known.last_seen)
            return
        info = ComponentInfo(
            address,
            summary.type,
            summary.autopilot,
            0,
            summary.custom_mode,
            common.MavState.UNINIT,
            known.first_seen if known else now,
            now,
            high_latency=True,
        )
        if known is None:
            self._found(info)
        else:
            self._take_in(info, now - known.last_seen)

    def _found(self, info: ComponentInfo) -> bool:
        if len(self.components) >= MOST_COMPONENTS or 0 in info.address:
            return False
        self.components[info.address] = info
        self._claims[info.address] = Claims()
        self._look_at = earliest(self._look_at, info.last_seen + info.timeout)
        self.emit(ComponentFound(info))
        return True

    def _take_in(self, info: ComponentInfo, silence: float) -> None:
        if not self.components[info.address].alive:
            info = replace(info, alive=True)
            self.emit(ComponentReturned(info, silence))
        self.components[info.address] = info
        due = info.last_seen + info.timeout
        if self._look_at is None or due < self._look_at:
            self._look_at = due

    def _lose(self, info: ComponentInfo, reason: str) -> None:
        self._pulses.pop(info.address, None)
        self.components[info.address] = lost = replace(info, alive=False)
        self.emit(ComponentLost(lost, reason))

    def _judge(self, address: Address, verdict: Verdict, now: float) -> None:
        match verdict:
            case Verdict.REBOOTED:
                self.emit(ComponentRebooted(self.components[address]))
            case Verdict.CLASH:
                self.emit(AddressClash(self.components[address], self._claims[address].all(now)))
            case Verdict.CLASH_OVER:
                self.emit(AddressClashOver(self.components[address]))

    def _is_taken(self, heartbeat: common.Heartbeat, now: float) -> None:
        if self._taken_at is None or now - self._taken_at > OVER:
            self.emit(OwnAddressConflict(_introduction(self.local, heartbeat, now, None)))
        self._taken_at = now


def _kind(info: ComponentInfo) -> tuple[int, int]:
    return int(info.type), int(info.autopilot)


def _introduction(
    address: Address, heartbeat: common.Heartbeat, now: float, known: ComponentInfo | None
) -> ComponentInfo:
    return ComponentInfo(
        address,
        heartbeat.type,
        heartbeat.autopilot,
        heartbeat.base_mode,
        heartbeat.custom_mode,
        heartbeat.system_status,
        known.first_seen if known else now,
        now,
        alive=known.alive if known else True,
    )
