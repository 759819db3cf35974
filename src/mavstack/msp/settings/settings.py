"""The settings of one flight controller: definitions, messages to read, and the one that changes a value."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.errors import InvalidArgumentError, MspFirmwareError
from mavstack.msp.firmware_info import BETAFLIGHT, INAV, FirmwareInfo
from mavstack.msp.settings.tables import ALL_SETTINGS

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from mavstack.msp.messages.base import MspMessage
    from mavstack.msp.messages.layout import TableMessage
    from mavstack.msp.settings.definition import SettingDefinition, Value

OLDEST_APIS = {BETAFLIGHT: (1, 40), INAV: (2, 3)}
"""The oldest versions whose layouts are known: those of Betaflight 4.0 and iNav 2.3."""


class Settings:
    """The settings of one flight controller.

    Args:
        firmware: The identity of the flight controller.
        name: What error texts call the flight controller.
    """

    def __init__(self, firmware: FirmwareInfo, name: str = "the flight controller") -> None:
        self.firmware = firmware
        self._name = name
        self._all = {known: item for item in ALL_SETTINGS for known in (item.name, *item.aliases)}
        here = [item for item in ALL_SETTINGS if item.is_in(firmware)] if not self._refusal() else []
        self._definitions = tuple(here)
        self._by_name = {known: item for item in here for known in (item.name, *item.aliases)}

    @property
    def definitions(self) -> tuple[SettingDefinition, ...]:
        """The settings that the firmware has; empty if its version is too old."""
        return self._definitions

    def find(self, name: str) -> SettingDefinition:
        """Return the definition of a setting.

        Args:
            name: Its name or alias.

        Raises:
            InvalidArgumentError: No firmware has a setting of this name.
            MspFirmwareError: This firmware, or its version, does not have it; the text holds the reason.
        """
        found = self._by_name.get(name)
        if found is not None:
            return found
        known = self._all.get(name)
        if known is None:
            raise InvalidArgumentError(f"there is no setting {name!r}; `mav msp get` lists them")
        raise MspFirmwareError(
            f"setting {name} of", self._name, answer=self._refusal() or known.absence(self.firmware)
        )

    def reads(self, names: Iterable[str] | None = None) -> tuple[type[TableMessage], ...]:
        """Return the messages that have settings, each once.

        Args:
            names: The settings that are wanted; None for all.

        Raises:
            InvalidArgumentError: No firmware has a setting of one of the names.
            MspFirmwareError: This firmware, or its version, does not have one of them.
        """
        wanted = self._definitions if names is None else [self.find(name) for name in names]
        return tuple(dict.fromkeys(item.read for item in wanted))

    def values(self, messages: Mapping[type[MspMessage], MspMessage]) -> dict[str, Value]:
        """Return the values of all settings that are in some messages.

        Args:
            messages: Messages that were read, by their classes.
        """
        found = {}
        for item in self._definitions:
            message = messages.get(item.read)
            value = None if message is None else item.value_in(message)
            if value is not None:
                found[item.name] = value
        return found

    def change(self, message: TableMessage, name: str, value: Value) -> TableMessage:
        """Return the message that gives a setting another value.

        Args:
            message: The message that has the setting, as it was read just before.
            name: The setting.
            value: The new value.

        Raises:
            InvalidArgumentError: The value is outside the range of the setting.
            MspFirmwareError: The firmware does not have the setting, or its layouts are not known.
        """
        item = self.find(name)
        if self.firmware.variant not in OLDEST_APIS:
            answer = f"settings of {self.firmware.firmware} are only read, because its layouts are not known"
            raise MspFirmwareError(f"writing setting {name} of", self._name, answer=answer)
        if item.value_in(message) is None:
            raise MspFirmwareError(
                f"writing setting {name} of", self._name, answer="the firmware does not send it"
            )
        return item.message(message, item.checked(value))

    def _refusal(self) -> str:
        """Return the reason why no settings of the firmware are known, "" if they are."""
        firmware = self.firmware
        oldest = OLDEST_APIS.get(INAV if firmware.is_inav else BETAFLIGHT, (0, 0))
        if firmware.api >= oldest:
            return ""
        versions = (
            f"version {firmware.api[0]}.{firmware.api[1]} of MSP, settings need {oldest[0]}.{oldest[1]}"
        )
        return f"{firmware.firmware} {firmware.version_text} has {versions}"
