"""A flight controller without a line, for tests in virtual time: it answers by a table of messages."""

from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from mavstack.bridges.msp.bridge import MspBridge
from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError, MspDenied, MspTimeout
from mavstack.links.memory import MemoryNetwork
from mavstack.msp import FirmwareInfo
from mavstack.msp.messages.arming import InavArmingFlag, SensorFlag
from mavstack.msp.messages.battery import Analog, BatteryAlert, BatteryState, InavAnalog
from mavstack.msp.messages.config import Feature, FeatureConfig
from mavstack.msp.messages.gps import RawGps
from mavstack.msp.messages.identification import BoardInfo
from mavstack.msp.messages.modes import BoxIds, BoxNames, ModeRange, ModeRanges
from mavstack.msp.messages.motors import InavMixer, MixerConfig, Motor
from mavstack.msp.messages.navigation import (
    LAST_WAYPOINT_FLAG,
    NavError,
    NavMode,
    NavState,
    NavStatus,
    SetWp,
    WaypointAction,
    Wp,
    WpInfo,
)
from mavstack.msp.messages.rc import Rc, RxConfig, RxMap, SetRawRc
from mavstack.msp.messages.sensors import Altitude, Attitude, RawImu
from mavstack.msp.messages.status import InavStatus, StatusEx
from mavstack.sim.virtual import run_virtually
from mavstack.vehicle import connect

if TYPE_CHECKING:
    from collections.abc import Callable

#: Boxes by permanent id, in the order of the status bits.
BETAFLIGHT_BOXES = {0: "ARM", 1: "ANGLE", 2: "HORIZON", 13: "BEEPER", 27: "FAILSAFE", 46: "GPS RESCUE"}
INAV_BOXES = {0: "ARM", 1: "ANGLE", 10: "NAV RTH", 11: "NAV POSHOLD", 28: "NAV WP", 27: "FAILSAFE"}
#: The AUX channel and the range of each switch: ARM on AUX 1, modes on AUX 2.
RANGES = {
    "BTFL": (ModeRange(0, 0, 1700, 2100), ModeRange(1, 1, 1300, 1700), ModeRange(46, 1, 1700, 2100)),
    "INAV": (ModeRange(0, 0, 1700, 2100), ModeRange(1, 1, 1300, 1500), ModeRange(28, 1, 1700, 2100)),
}
ANSWER_TIME = 0.002
SIGNAL_TIMEOUT = 0.3
PULSE_CHANNELS = 16


@dataclass(frozen=True)
class FakeSetting:
    """The definition of a setting."""

    name: str
    type: int = common.MavParamType.UINT8
    minimum: int = 0
    maximum: int = 200
    aliases: tuple[str, ...] = ()
    increment: float = 1.0
    unit: str = ""
    description: str = "A gain"
    values: dict[int, str] = field(default_factory=dict)


class FakeSettings:
    """The settings of a fake controller; `stuck` is a setting that keeps its value."""

    def __init__(self) -> None:
        self._definitions = (
            FakeSetting("BF_PID_ROLL_P"),
            FakeSetting(
                "BF_RC_EXPO",
                aliases=("BF_RATE_RC_EXPO", "BF_AN_ALIAS_THAT_IS_TOO_LONG"),
                unit="%",
                increment=0.01,
            ),
            FakeSetting("BF_FEATURES", common.MavParamType.UINT32, 0, 0xFFFFFFFF),
        )
        self.values: dict[str, int] = {"BF_PID_ROLL_P": 45, "BF_RC_EXPO": 10, "BF_FEATURES": 0xF000_0001}
        self.reads = 0
        self.refused = False

    def definitions(self) -> tuple[FakeSetting, ...]:
        return self._definitions

    async def all(self) -> dict[str, int]:
        self.reads += 1
        await asyncio.sleep(ANSWER_TIME * len(self.values))
        return dict(self.values)

    async def get(self, name: str) -> int:
        self.reads += 1
        await asyncio.sleep(ANSWER_TIME)
        return self.values[name]

    async def set(self, name: str, value: int) -> int:
        await asyncio.sleep(ANSWER_TIME)
        if self.refused:
            raise MspDenied("MSP_SET_PID on", "fake", answer="refused by the firmware")
        if value == 13:
            raise InvalidArgumentError("13 is refused")
        self.values[name] = value
        return value


@dataclass
class FakeController:
    """A fake `FlightController`.

    Attributes:
        variant: BTFL or INAV.
        receives_msp: True if its receiver takes channels by MSP.
        reasons: Reasons not to arm beside those that follow from the channels.
        silent: True while it answers nothing.
        receiver_delay: Seconds after which its receiver passes the channels on.
        on_armed: Called when it arms.
    """

    variant: str = "BTFL"
    receives_msp: bool = True
    reasons: int = 0
    silent: bool = False
    connected: bool = True
    name: str = "msp+fake"
    sent: list[Any] = field(default_factory=list)
    saved: int = 0
    channels: tuple[int, ...] = ()
    channels_at: float = -10.0
    armed: bool = False
    must_switch_off: bool = False
    receiver_delay: float = 0.0
    on_armed: Callable[[], object] = bool
    calibrating_until: float = -1.0
    waypoints: dict[int, SetWp] = field(default_factory=dict)
    polls: dict[type, int] = field(default_factory=dict)
    nav: NavStatus = field(
        default_factory=lambda: NavStatus(
            NavMode.NONE, NavState.NONE, WaypointAction.NONE, 0, NavError.NONE, 0
        )
    )

    def __post_init__(self) -> None:
        self.info = FirmwareInfo(self.variant, (4, 5, 1), (1, 46), "S405", uid="000102030405060708090a0b")
        self.settings = FakeSettings()
        boxes = INAV_BOXES if self.info.is_inav else BETAFLIGHT_BOXES
        self.boxes = tuple(boxes)
        self.messages: dict[type, Any] = {
            BoxIds: BoxIds(self.boxes),
            BoxNames: BoxNames(tuple(boxes.values())),
            ModeRanges: ModeRanges(RANGES[self.variant]),
            RxMap: RxMap((0, 1, 3, 2, 4, 5, 6, 7)),
            FeatureConfig: FeatureConfig(Feature.RX_MSP if self.receives_msp else Feature.RX_SERIAL),
            RxConfig: RxConfig(0, 1900, 1500, 1050, 0, receiver_type=2 if self.receives_msp else 1),
            BoardInfo: BoardInfo("S405"),
            MixerConfig: MixerConfig(3),
            InavMixer: InavMixer(0, 0, 0, 1, False, 3, 8, 8),
            Attitude: Attitude(10.0, 20.0, 350),
            Altitude: Altitude(12.5, 1.5, 12.0),
            RawGps: RawGps(2, 11, 47.0, 8.0, 500, 3.0, 90.0, 1.2),
            RawImu: RawImu((1, 2, 512), (3, 4, 5), (6, 7, 8)),
            Rc: Rc((1500, 1510, 1520, 1100, 1000, 2000)),
            Motor: Motor((1000, 1001, 1002, 1003, 0, 0, 0, 0)),
            BatteryState: BatteryState(4, 1500, 16.2, 300, 5.5, BatteryAlert.OK, 16.21),
            Analog: Analog(16.2, 300, 1023, 5.5, 16.21),
            InavAnalog: InavAnalog(0x40, 16.2, 5.5, 80.0, 300, 4.0, 1200, 80, 511),
        }

    @property
    def now(self) -> float:
        return asyncio.get_running_loop().time()

    @property
    def has_signal(self) -> bool:
        return self.now - self.channels_at < SIGNAL_TIMEOUT

    def active_modes(self) -> frozenset[int]:
        pulses = self.channels if self.has_signal else ()
        active = {
            each.mode
            for each in self.messages[ModeRanges].ranges
            if each.mode and len(pulses) > 4 and each.start <= pulses[4 + each.aux_channel] < each.end
        }
        return frozenset(active | ({0} if self.armed else set()))

    def status(self) -> StatusEx | InavStatus:
        bits = sum(1 << self.boxes.index(box) for box in self.active_modes() if box in self.boxes)
        sensors = SensorFlag(0x2F if self.info.is_inav else 0x29)
        calibrating = self.now < self.calibrating_until
        if self.info.is_inav:
            flags = self.reasons | (0 if self.has_signal else InavArmingFlag.RC_LINK)
            flags |= InavArmingFlag.SENSORS_CALIBRATING if calibrating else 0
            return InavStatus(0.001, 0, sensors, 12, 0, InavArmingFlag(flags), (bits, 0))
        flags = self.reasons | (0 if self.has_signal else 1 << 2) | (1 << 12 if calibrating else 0)
        flags |= 1 << 29 if self.must_switch_off else 0
        return StatusEx(
            0.001, 0, sensors, bits, 0, 12, pid_profile_count=3, rate_profile=0, extra_mode_flags=b"",
            arming_disable_flag_count=30, arming_disable_flags=flags, config_state_flags=0,
        )  # fmt: skip

    async def get(self, kind: type, argument: Any = b"", **_: Any) -> Any:
        await self._answer(kind)
        if kind in (StatusEx, InavStatus):
            return self.status()
        if kind is NavStatus:
            return self.nav
        if kind is WpInfo:
            last = [number for number, wp in self.waypoints.items() if wp.flag == LAST_WAYPOINT_FLAG]
            return WpInfo(0, 120, bool(last), max(last, default=len(self.waypoints)))
        if kind is Wp:
            return self._waypoint(argument.index)
        if kind not in self.messages:
            raise MspDenied(f"{kind.__name__} on", self.name, answer="refused by the firmware")
        return self.messages[kind]

    async def send(self, message: Any, **_: Any) -> None:
        await self._answer(type(message))
        self.sent.append(message)
        if isinstance(message, SetRawRc):
            loop = asyncio.get_running_loop()
            loop.call_later(self.receiver_delay, self._receive_channels, message.channels)
        if isinstance(message, SetWp):
            self._set_waypoint(message)

    async def open(self) -> FakeController:
        await self.identify()
        return self

    async def close(self) -> None:
        self.connected = False

    async def identify(self) -> FirmwareInfo:
        await self._answer(FirmwareInfo)
        return self.info

    async def save(self) -> None:
        await self._answer(FirmwareInfo)
        self.saved += 1

    def disarm_by_itself(self) -> None:
        """Disarm as after a crash: the arm switch must be off before it arms again."""
        self.armed, self.must_switch_off = False, True

    def sent_of(self, kind: type) -> list[Any]:
        return [message for message in self.sent if isinstance(message, kind)]

    async def _answer(self, kind: type) -> None:
        self.polls[kind] = self.polls.get(kind, 0) + 1
        if self.silent:
            await asyncio.sleep(0.5)
            raise MspTimeout(f"{kind.__name__} on", self.name, answer="no answer")
        await asyncio.sleep(ANSWER_TIME)

    def _receive_channels(self, channels: tuple[int, ...]) -> None:
        assert len(channels) == PULSE_CHANNELS
        had_signal = self.has_signal
        self.channels, self.channels_at = channels, self.now
        arm = self.messages[ModeRanges].ranges[0]
        on = arm.start <= channels[4 + arm.aux_channel] < arm.end
        blocked = self.reasons or channels[2] > 1050 or not had_signal
        was_armed, self.must_switch_off = self.armed, self.must_switch_off and on
        self.armed = on and not self.must_switch_off and (self.armed or not blocked)
        if self.armed and not was_armed:
            self.on_armed()

    def _set_waypoint(self, waypoint: SetWp) -> None:
        if waypoint.index == 1:
            self.waypoints.clear()
        self.waypoints[waypoint.index] = waypoint

    def _waypoint(self, index: int) -> Wp:
        if index == 0:
            return Wp(0, WaypointAction.WAYPOINT, 47.0, 8.0, 0.0, 0, 0, 0, 0x48)
        return Wp.decode(self.waypoints[index].encode(self.info), self.info)  # in whole centimeters


@asynccontextmanager
async def bridged(controller: FakeController | None = None, **settings: Any):
    """Yield a connection to the vehicle of a fake controller, and the controller."""
    controller = controller or FakeController(**settings)
    network = MemoryNetwork(lambda: asyncio.get_running_loop().time() + 1e9)
    async with (
        MspBridge(controller, network.link()) as bridge,
        connect(network.link()) as connection,
    ):
        yield connection, controller, bridge


def run(scenario, **settings: Any) -> None:
    """Run a scenario with a vehicle, its fake controller and its bridge, in virtual time."""

    async def work() -> None:
        async with bridged(**settings) as (connection, controller, bridge):
            vehicle = await connection.wait_for_vehicle()
            await asyncio.wait_for(scenario(vehicle, controller, bridge), 600)

    run_virtually(work())


def moved(waypoint: SetWp, **changes: Any) -> SetWp:
    return replace(waypoint, **changes)
