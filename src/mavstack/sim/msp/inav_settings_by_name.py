"""Settings of iNav by their CLI names over MSP: MSP2_COMMON_SETTING, and those that write and describe.

A request names a setting by a text that ends with a NUL. Values are little-endian, as wide as their type.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.msp.commands import MspCommand as Command
from mavstack.sim.msp.system import RefusedError

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.sim.msp.cli_settings import CliSetting
    from mavstack.sim.msp.port import MspPort
    from mavstack.sim.msp.system import System

#: Types of settings in MSP2_COMMON_SETTING_INFO: type number, whether signed, number of bytes.
_TYPES: Final = {(False, 1): 0, (True, 1): 1, (False, 2): 2, (True, 2): 3, (False, 4): 4, (True, 4): 4}
_STRING_TYPE: Final = 6
_MODE_DIRECT, _MODE_LOOKUP = 0, 1 << 6


def setting_by_name_handlers(system: System) -> dict[int, Callable[[bytes, MspPort], bytes]]:
    """Return the handlers by command."""
    return {
        Command.MSP2_COMMON_SETTING: lambda payload, _: _read(system, payload),
        Command.MSP2_COMMON_SET_SETTING: lambda payload, _: _write(system, payload),
        Command.MSP2_COMMON_SETTING_INFO: lambda payload, _: _describe(system, payload),
    }


def _find(system: System, payload: bytes) -> tuple[CliSetting, bytes]:
    """Return the setting that a request names, and the bytes behind the name."""
    name, _, rest = payload.partition(b"\0")
    setting = system.cli_settings.get(name.decode("ascii", "replace"))
    if setting is None:
        raise RefusedError
    return setting, rest


def _width(setting: CliSetting) -> tuple[bool, int]:
    """Return whether a setting has a sign, and its bytes."""
    signed = setting.minimum < 0
    size = next(size for size in (1, 2, 4) if setting.maximum < 1 << 8 * size - signed)
    return signed, size


def _read(system: System, payload: bytes) -> bytes:
    setting, _ = _find(system, payload)
    value = setting.value(system.settings)
    if setting.is_text:
        return str(value).encode() + b"\0"
    signed, size = _width(setting)
    return int(value).to_bytes(size, "little", signed=signed)


def _write(system: System, payload: bytes) -> bytes:
    setting, data = _find(system, payload)
    if setting.is_text:
        setting.store(system.settings, data.split(b"\0")[0].decode("ascii", "replace")[: setting.maximum])
        return b""
    signed, size = _width(setting)
    value = int.from_bytes(data[:size], "little", signed=signed)
    highest = len(setting.words) - 1 if setting.words else setting.maximum
    if len(data) < size or not setting.minimum <= value <= highest:
        raise RefusedError
    setting.store(system.settings, value)
    system.configure()
    return b""


def _describe(system: System, payload: bytes) -> bytes:
    """Return name, group, type, section, mode, limits, index, profile, and the words of a setting."""
    setting, _ = _find(system, payload)
    signed, size = _width(setting)
    kind = _STRING_TYPE if setting.is_text else _TYPES[signed, size]
    highest = len(setting.words) - 1 if setting.words else setting.maximum
    index = [each.name for each in system.cli_settings].index(setting.name)
    words = b"".join(word.encode() + b"\0" for word in setting.words)
    return b"".join(
        (
            setting.name.encode() + b"\0",
            b"\0\0",
            bytes([kind, 0, _MODE_LOOKUP if setting.words else _MODE_DIRECT]),
            setting.minimum.to_bytes(4, "little", signed=True),
            highest.to_bytes(4, "little"),
            index.to_bytes(2, "little"),
            b"\0\0",
            words,
        )
    )
