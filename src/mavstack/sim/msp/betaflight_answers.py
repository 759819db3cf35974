"""The answers of Betaflight alone: status, meters, arming lock, texts, display, video and profiles."""

from __future__ import annotations

import dataclasses
import struct
from time import gmtime
from typing import TYPE_CHECKING, Final

from mavstack.msp.commands import MspCommand as Command
from mavstack.msp.messages.arming import SensorFlag
from mavstack.msp.messages.battery import CurrentMeters, VoltageMeters
from mavstack.msp.messages.config import CfSerialConfig, LegacySerialPort, Rtc, SerialConfig, SerialFunction
from mavstack.msp.messages.identification import Name
from mavstack.msp.messages.motors import MotorTelemetry
from mavstack.msp.messages.osd import GENERAL_SETTINGS, TIMER_SETTINGS, OsdConfig, SetOsdConfig
from mavstack.msp.messages.pid import Pid, PidAdvanced
from mavstack.msp.messages.sensors import AttitudeQuaternion
from mavstack.msp.messages.status import Status, StatusEx
from mavstack.msp.messages.vtx import SetVtxConfig, VtxConfig, VtxTableBand, VtxTablePowerLevel
from mavstack.sim.msp import telemetry
from mavstack.sim.msp.answers import common_handlers, setting_handlers
from mavstack.sim.msp.settings import PROFILES
from mavstack.sim.msp.system import RefusedError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from mavstack.msp.messages.base import MspMessage
    from mavstack.sim.msp.port import MspPort
    from mavstack.sim.msp.system import System

    Handler = Callable[[bytes, MspPort], bytes]

SENSORS: Final = (
    SensorFlag.ACCELEROMETER
    | SensorFlag.BAROMETER
    | SensorFlag.MAGNETOMETER
    | SensorFlag.GPS
    | SensorFlag.GYRO
)
#: Bands of the video transmitter: name, letter and frequencies in MHz.
VTX_BANDS: Final = (
    ("BOSCAM_A", "A", (5865, 5845, 5825, 5805, 5785, 5765, 5745, 5725)),
    ("BOSCAM_B", "B", (5733, 5752, 5771, 5790, 5809, 5828, 5847, 5866)),
    ("BOSCAM_E", "E", (5705, 5685, 5665, 5645, 5885, 5905, 5925, 5945)),
    ("FATSHARK", "F", (5740, 5760, 5780, 5800, 5820, 5840, 5860, 5880)),
    ("RACEBAND", "R", (5658, 5695, 5732, 5769, 5806, 5843, 5880, 5917)),
)
#: Power levels of the video transmitter: value and label.
VTX_POWERS: Final = ((14, "25"), (20, "100"), (26, "400"), (29, "800"))
#: Texts of MSP2_GET_TEXT: pilot, craft, PID profile, rate profile, build key, release.
PILOT_NAME, CRAFT_NAME, PID_PROFILE_NAME, RATE_PROFILE_NAME, BUILD_KEY, RELEASE_NAME = range(1, 7)
#: Numbers from this one in MSP_SET_VTX_CONFIG are frequencies; lower numbers combine band and channel.
_FREQUENCIES: Final = 64
_CYCLE_TIME: Final = 125e-6
_LOAD: Final = 8
_TEMPERATURE: Final = 38
MAX_MULTIPLE_REPLY: Final = 320
_EPOCH_FORMAT: Final = struct.Struct("<iH")


def make_handlers(system: System) -> Mapping[int, Handler]:
    """Return the handlers of Betaflight by command."""
    own = BetaflightAnswers(system)
    handlers = common_handlers(system)
    handlers |= setting_handlers(system, "BTFL")
    for command, produce in own.producers():
        handlers[command] = system.producer(produce)
    for command, act in own.actions():
        handlers[command] = system.action(act)
    return handlers | {
        Command.MSP_MODE_RANGES_EXTRA: lambda *_: own.mode_ranges_extra(),
        Command.MSP_RESET_CONF: lambda payload, port: own.reset(payload, port, handlers),
        Command.MSP_MULTIPLE_MSP: lambda payload, port: own.multiple(payload, port, handlers),
        Command.MSP2_GET_TEXT: lambda payload, _: own.get_text(payload),
        Command.MSP_VTXTABLE_BAND: lambda payload, _: own.vtx_band(payload),
        Command.MSP_VTXTABLE_POWERLEVEL: lambda payload, _: own.vtx_power(payload),
    }


class BetaflightAnswers:
    """The handlers that are more than a message of the settings."""

    def __init__(self, system: System) -> None:
        self._system = system
        self._texts = {
            PILOT_NAME: "",
            PID_PROFILE_NAME: "",
            RATE_PROFILE_NAME: "",
            BUILD_KEY: "",
            RELEASE_NAME: "4.5.2",
        }
        #: Seconds to add to the simulation time for the clock that a peer has set; None if no peer has set
        #: it.
        self._clock: float | None = None

    def producers(self) -> list[tuple[int, Callable[[System], MspMessage]]]:
        """Return the functions that make messages, by command."""
        return [
            (Command.MSP_STATUS, lambda _: self._status()),
            (Command.MSP_STATUS_EX, lambda _: self._status_ex()),
            (VoltageMeters.COMMAND, telemetry.voltage_meters),
            (CurrentMeters.COMMAND, telemetry.current_meters),
            (MotorTelemetry.COMMAND, telemetry.motor_telemetry),
            (AttitudeQuaternion.COMMAND, telemetry.quaternion),
            (Command.MSP_RTC, lambda _: self._rtc()),
            (Command.MSP_CF_SERIAL_CONFIG, lambda _: self._legacy_ports()),
        ]

    def actions(self) -> list[tuple[int, Callable[[bytes, MspPort], None]]]:
        """Return the functions that act, by command."""
        return [
            (Command.MSP_SET_ARMING_DISABLED, self._set_arming_disabled),
            (Command.MSP_SET_RTC, lambda payload, _: self._set_rtc(payload)),
            (Command.MSP2_SET_TEXT, lambda payload, _: self._set_text(payload)),
            (Command.MSP_SET_OSD_CONFIG, lambda payload, _: self._set_osd(payload)),
            (Command.MSP_SET_VTX_CONFIG, lambda payload, _: self._set_vtx(payload)),
            (Command.MSP_COPY_PROFILE, lambda payload, _: self._copy_profile(payload)),
            (Command.MSP_SET_RESET_CURR_PID, lambda *_: self._reset_pid()),
            (Command.MSP2_SEND_DSHOT_COMMAND, lambda payload, _: self._send_dshot_command(payload)),
            (Command.MSP_SET_TX_INFO, lambda *_: None),
            (Command.MSP_SET_HEADING, lambda *_: None),
            (Command.MSP_SET_PID_CONTROLLER, lambda *_: None),
            (Command.MSP_DATAFLASH_ERASE, lambda *_: self._system.host.announce("text", "flash chip erased")),
        ]

    # --- status

    def _common(self) -> dict[str, object]:
        system = self._system
        flags = system.boxes.flags(system.active_boxes())
        count = len(system.boxes.boxes)
        return {
            "cycle_time": _CYCLE_TIME,
            "i2c_errors": 0,
            "sensors": SENSORS,
            "mode_flags": flags & 0xFFFF_FFFF,
            "pid_profile": system.settings.pid_profile,
            "load": _LOAD,
            "extra_mode_flags": (flags >> 32).to_bytes(max(count - 32 + 7, 0) // 8, "little"),
            "arming_disable_flag_count": len(system.reasons),
            "arming_disable_flags": system.arming.flags,
            "config_state_flags": 0,
            "core_temperature": _TEMPERATURE,
            "rate_profile_count": PROFILES,
            "battery_profile_count": 1,
            "battery_profile": 0,
        }

    def _status(self) -> Status:
        return Status(**self._common(), gyro_cycle_time=0)  # type: ignore[arg-type]

    def _status_ex(self) -> StatusEx:
        rate_profile = self._system.settings.rate_profile
        return StatusEx(**self._common(), pid_profile_count=PROFILES, rate_profile=rate_profile)  # type: ignore[arg-type]

    def mode_ranges_extra(self) -> bytes:
        """Return MSP_MODE_RANGES_EXTRA."""
        ranges = self._system.settings.mode_ranges
        items = (bytes([each.permanent_id, each.logic, each.linked_to]) for each in ranges)
        return bytes([len(ranges)]) + b"".join(items)

    def _set_arming_disabled(self, payload: bytes, port: MspPort) -> None:
        (disabled,) = struct.unpack_from("<B", payload)
        if disabled:
            self._system.arming_disabled_by.add(port)
            self._system.arming.disarm("MSP")
        else:
            self._system.arming_disabled_by.discard(port)

    def _legacy_ports(self) -> CfSerialConfig:
        """Return the serial ports in the older layout, which has the first sixteen functions."""
        ports = []
        for each in self._system.settings.get(SerialConfig).ports:
            changes = {"functions": SerialFunction(each.functions & 0xFFFF)}
            fields = {field.name: getattr(each, field.name) for field in dataclasses.fields(each)}
            ports.append(LegacySerialPort(**(fields | changes)))
        return CfSerialConfig(tuple(ports))

    # --- clock and texts

    def _rtc(self) -> Rtc:
        if self._clock is None:
            return Rtc()
        seconds = self._system.now + self._clock
        time = gmtime(seconds)
        return Rtc(
            time.tm_year,
            time.tm_mon,
            time.tm_mday,
            time.tm_hour,
            time.tm_min,
            time.tm_sec,
            int(seconds % 1 * 1000),
        )

    def _set_rtc(self, payload: bytes) -> None:
        seconds, milliseconds = _EPOCH_FORMAT.unpack_from(payload)
        self._clock = seconds + milliseconds / 1000 - self._system.now

    def get_text(self, payload: bytes) -> bytes:
        """Return MSP2_GET_TEXT."""
        (kind,) = struct.unpack_from("<B", payload)
        if kind == CRAFT_NAME:
            text = self._system.settings.get(Name).name
        elif kind in self._texts:
            text = self._texts[kind]
        else:
            raise RefusedError
        return bytes([kind, len(text)]) + text.encode()

    def _set_text(self, payload: bytes) -> None:
        kind, length = struct.unpack_from("<BB", payload)
        text = payload[2 : 2 + length].decode("ascii", "replace")[:16]
        if kind == CRAFT_NAME:
            self._system.settings.put(Name(text))
        elif kind in (PILOT_NAME, PID_PROFILE_NAME, RATE_PROFILE_NAME):
            self._texts[kind] = text
        else:
            raise RefusedError

    # --- display and video

    def _set_osd(self, payload: bytes) -> None:
        settings, present = self._system.settings, self._system.settings.get(OsdConfig)
        (address,) = struct.unpack_from("<B", payload)
        if address == GENERAL_SETTINGS:
            settings.update(OsdConfig, SetOsdConfig.decode(payload, self._system.info))
        elif address == TIMER_SETTINGS:
            _, index, value = struct.unpack_from("<BBH", payload)
            settings.put(dataclasses.replace(present, timers=_with_item(present.timers, index, value)))
        else:
            _, value = struct.unpack_from("<BH", payload)
            if payload[3:4] == b"\0":  # screen 0 means that the value shows or hides a statistic
                changed = dataclasses.replace(
                    present, statistics=_with_item(present.statistics, address, value)
                )
            else:
                changed = dataclasses.replace(present, items=_with_item(present.items, address, value))
            settings.put(changed)

    def _set_vtx(self, payload: bytes) -> None:
        settings, written = self._system.settings, SetVtxConfig.decode(payload, self._system.info)
        settings.update(VtxConfig, written)
        band, channel = written.band, written.channel
        # The older format has one number for band and channel.
        if band is None and written.combined < _FREQUENCIES:
            band, channel = written.combined // 8 + 1, written.combined % 8 + 1
        if band and 1 <= band <= len(VTX_BANDS) and channel and 1 <= channel <= 8:
            frequency = VTX_BANDS[band - 1][2][channel - 1]
            present = settings.get(VtxConfig)
            settings.put(dataclasses.replace(present, band=band, channel=channel, frequency=frequency))

    def vtx_band(self, payload: bytes) -> bytes:
        """Return MSP_VTXTABLE_BAND."""
        (band,) = struct.unpack_from("<B", payload)
        if not 1 <= band <= len(VTX_BANDS):
            raise RefusedError
        name, letter, frequencies = VTX_BANDS[band - 1]
        return self._system.encode(VtxTableBand(band, name, letter, True, frequencies))

    def vtx_power(self, payload: bytes) -> bytes:
        """Return MSP_VTXTABLE_POWERLEVEL."""
        (level,) = struct.unpack_from("<B", payload)
        if not 1 <= level <= len(VTX_POWERS):
            raise RefusedError
        return self._system.encode(VtxTablePowerLevel(level, *VTX_POWERS[level - 1]))

    # --- profiles and actions

    def _copy_profile(self, payload: bytes) -> None:
        kind, target, source = struct.unpack_from("<BBB", payload)
        self._system.settings.copy_profile(target, source, is_rate_profile=kind == 1)

    def _reset_pid(self) -> None:
        settings = self._system.settings
        for kind in (Pid, PidAdvanced):
            settings.put(settings.default(kind))

    def reset(self, payload: bytes, port: MspPort, handlers: Mapping[int, Handler]) -> bytes:
        """Answer MSP_RESET_CONF, and say that it is done."""
        handlers[Command.MSP_RESET_CONF](payload, port)
        return b"\1"

    def multiple(self, payload: bytes, port: MspPort, handlers: Mapping[int, Handler]) -> bytes:
        """Answer MSP_MULTIPLE_MSP: the replies to several requests, each behind its length."""
        reply = b""
        for command in payload:
            if command not in handlers:
                raise RefusedError
            part = handlers[command](b"", port)
            if len(part) > 255 or len(reply) + len(part) > MAX_MULTIPLE_REPLY:
                break
            reply += bytes([len(part)]) + part
        return reply

    def _send_dshot_command(self, payload: bytes) -> None:
        if self._system.arming.armed:
            raise RefusedError
        commands = ", ".join(
            str(number) for number in payload[3 : 3 + (payload[2] if len(payload) > 2 else 0)]
        )
        self._system.host.announce("beeper", f"DSHOT command {commands}")


def _with_item(items: tuple[int, ...] | None, index: int, value: int) -> tuple[int, ...]:
    """Return a list with another value at an index; raises RefusedError for an index outside of it."""
    if items is None or index >= len(items):
        raise RefusedError
    return (*items[:index], value, *items[index + 1 :])
