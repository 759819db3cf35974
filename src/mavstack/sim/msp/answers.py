"""Answers that both firmwares give: identification, telemetry, settings, boxes, RC, EEPROM and reboot."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING, Final

from mavstack.msp.commands import MspCommand as Command
from mavstack.msp.messages.identification import (
    ApiVersion,
    BoardInfo,
    BuildInfo,
    FcVariant,
    FcVersion,
    Name,
    Uid,
)
from mavstack.msp.messages.modes import BoxIds, BoxNames
from mavstack.msp.messages.motors import SetMotor
from mavstack.msp.messages.rc import SetRawRc
from mavstack.msp.messages.registry import all_messages
from mavstack.sim.msp.boxes import ModeRange
from mavstack.sim.msp.passthrough import start_passthrough
from mavstack.sim.msp.receiver import CHANNELS
from mavstack.sim.msp.system import RefusedError
from mavstack.sim.msp.telemetry import COMMON

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from mavstack.msp.messages.base import MspMessage
    from mavstack.sim.msp.port import MspPort
    from mavstack.sim.msp.system import System

    Handler = Callable[[bytes, MspPort], bytes]

#: Number of boxes in one reply of MSP_BOXNAMES.
PAGE: Final = 32
#: Bit of MSP_SELECT_SETTING that is set if the number selects a rate profile.
RATE_PROFILE: Final = 0x80
_PROTOCOL: Final = 0
#: The first API version of Betaflight that reports the firmware version as text.
_VERSION_TEXT_API: Final = (1, 47)
#: Bytes of a mode range and its index, without the optional logic and link.
_RANGE_SIZE: Final = 5
MAX_NAME_LENGTH: Final = 16
#: Value of MSP_REBOOT that restarts the firmware; others start a boot loader, which is not simulated.
_REBOOT_FIRMWARE: Final = 0


def common_handlers(system: System) -> dict[int, Handler]:
    """Return the handlers of both firmwares by command."""
    handlers: dict[int, Handler] = {kind.COMMAND: system.producer(produce) for kind, produce in COMMON}
    for message in _identification(system):
        handlers[message.COMMAND] = _constant(system.encode(message))
    return handlers | {
        Command.MSP_NAME: system.reader(Name),
        Command.MSP_SET_NAME: system.action(lambda payload, _: _set_name(system, payload)),
        Command.MSP_BOXNAMES: lambda payload, _: _box_names(system, payload),
        Command.MSP_BOXIDS: lambda payload, _: _box_ids(system, payload),
        Command.MSP_SET_RAW_RC: system.action(lambda payload, _: _set_raw_rc(system, payload)),
        Command.MSP_SET_MOTOR: system.action(lambda payload, _: _set_motor(system, payload)),
        Command.MSP_SET_MODE_RANGE: system.action(lambda payload, _: _set_mode_range(system, payload)),
        Command.MSP_MODE_RANGES: lambda payload, _: _mode_ranges(system),
        Command.MSP_ACC_CALIBRATION: system.action(lambda *_: system.calibrate("accelerometer")),
        Command.MSP_MAG_CALIBRATION: system.action(lambda *_: system.calibrate("compass")),
        Command.MSP_EEPROM_WRITE: system.action(lambda *_: system.save()),
        Command.MSP_RESET_CONF: system.action(lambda *_: _reset(system)),
        Command.MSP_SELECT_SETTING: system.action(lambda payload, _: _select(system, payload)),
        Command.MSP_REBOOT: lambda payload, _: _reboot(system, payload),
        Command.MSP_SET_PASSTHROUGH: lambda payload, port: start_passthrough(system, payload, port),
    }


def setting_handlers(system: System, variant: str) -> dict[int, Handler]:
    """Return the handlers that read and write messages of the settings; MSP_SET_PID writes MSP_PID.

    Args:
        system: The firmware.
        variant: Its identifier in MSP_FC_VARIANT.
    """
    messages = [each for each in all_messages() if variant in each.VARIANTS]
    replies: list[type[MspMessage]] = [BoardInfo, *(each for each in messages if each.IS_REPLY)]
    stored = {kind.NAME: kind for kind in replies if kind in system.settings}
    handlers: dict[int, Handler] = {kind.COMMAND: system.reader(kind) for kind in stored.values()}
    for written in messages:
        if written.IS_REPLY:
            continue
        read = stored.get(written.NAME.replace("_SET_", "_", 1))
        if read is not None:
            handlers[written.COMMAND] = system.writer(read, written)
    return handlers


def _identification(system: System) -> Iterable[MspMessage]:
    info = system.info
    date, time, revision = info.build.rsplit(" ", 2)
    yield ApiVersion(_PROTOCOL, *info.api)
    yield FcVariant(info.variant)
    has_text = not info.is_inav and info.api >= _VERSION_TEXT_API
    yield FcVersion(*info.version, info.version_text if has_text else None)
    yield BuildInfo(date, time, revision)
    yield Uid(info.uid)


def _constant(payload: bytes) -> Handler:
    return lambda *_: payload


def _set_name(system: System, payload: bytes) -> None:
    name = Name.decode(payload)
    if len(name.name) > MAX_NAME_LENGTH:
        raise RefusedError
    system.settings.put(name)


def _page(payload: bytes) -> slice:
    page = payload[0] if payload else 0
    return slice(page * PAGE, (page + 1) * PAGE)


def _box_names(system: System, payload: bytes) -> bytes:
    boxes = system.boxes.boxes
    shown = boxes if system.is_inav else boxes[_page(payload)]
    return system.encode(BoxNames(tuple(box.name for box in shown)))


def _box_ids(system: System, payload: bytes) -> bytes:
    boxes = system.boxes.boxes
    shown = boxes if system.is_inav else boxes[_page(payload)]
    return system.encode(BoxIds(tuple(box.permanent_id for box in shown)))


def _set_raw_rc(system: System, payload: bytes) -> None:
    channels = SetRawRc.decode(payload[: len(payload) & ~1]).channels
    if len(channels) > CHANNELS:
        raise RefusedError
    system.receiver.receive(channels, system.now)


def _set_motor(system: System, payload: bytes) -> None:
    if not system.arming.armed:
        pulses = SetMotor.decode(payload[: len(payload) & ~1]).motors
        system.motor_test[: len(pulses)] = pulses[: len(system.motor_test)]


def _mode_ranges(system: System) -> bytes:
    ranges = system.settings.mode_ranges
    return b"".join(
        bytes([each.permanent_id, each.aux_channel, each.start_step, each.end_step]) for each in ranges
    )


def _set_mode_range(system: System, payload: bytes) -> None:
    """Write one mode range, as both firmwares lay it out; Betaflight adds logic and link."""
    if len(payload) < _RANGE_SIZE:
        raise RefusedError
    index, *fields = payload[:_RANGE_SIZE]
    if index >= len(system.settings.mode_ranges) or fields[0] not in system.boxes:
        raise RefusedError
    if len(payload) >= _RANGE_SIZE + 2:
        if payload[6] not in system.boxes:
            raise RefusedError
        fields += payload[5:7]
    system.settings.mode_ranges[index] = ModeRange(*fields)


def _select(system: System, payload: bytes) -> None:
    (value,) = struct.unpack_from("<B", payload)
    if not system.arming.armed:
        system.settings.select(value & ~RATE_PROFILE, is_rate_profile=bool(value & RATE_PROFILE))


def _reset(system: System) -> None:
    if system.arming.armed:
        raise RefusedError
    system.settings.reset()
    system.configure()
    system.save()


def _reboot(system: System, payload: bytes) -> bytes:
    kind = payload[0] if payload else _REBOOT_FIRMWARE
    if system.arming.armed or kind != _REBOOT_FIRMWARE:
        raise RefusedError
    system.host.request_reboot()
    return b"" if system.is_inav else bytes([kind])
