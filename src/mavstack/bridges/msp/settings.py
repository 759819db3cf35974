"""The settings of a flight controller by their names: `FlightController.settings`.

    async with FlightController("msp+serial:///dev/ttyACM0") as controller:
        print(await controller.settings.get("BF_PID_ROLL_P"))
        await controller.settings.set("BF_PID_ROLL_P", 50)
        await controller.settings.save()

A value that was set is read back. It is lost with the next restart unless `save` is called.
"""

from __future__ import annotations

import asyncio
from contextlib import suppress
from typing import TYPE_CHECKING, TypeVar

from mavstack.errors import MspDenied, MspSettingError
from mavstack.msp.requests import Priority
from mavstack.msp.settings import Settings

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.bridges.msp.flight_controller import FlightController
    from mavstack.msp.messages.base import MspMessage
    from mavstack.msp.messages.layout import TableMessage
    from mavstack.msp.settings import SettingDefinition, Value


M = TypeVar("M", bound="MspMessage")


class ControllerSettings:
    """The settings of one flight controller.

    Args:
        controller: The flight controller.
    """

    def __init__(self, controller: FlightController) -> None:
        self._controller = controller
        self._settings: Settings | None = None
        self._changing = asyncio.Lock()

    def definitions(self) -> tuple[SettingDefinition, ...]:
        """Return the settings that the firmware has."""
        return self._current().definitions

    def definition(self, name: str) -> SettingDefinition:
        """Return the definition of a setting.

        Args:
            name: Its name or alias.

        Raises:
            InvalidArgumentError: There is no such setting.
            MspFirmwareError: The firmware, or its version, does not have it.
        """
        return self._current().find(name)

    async def get(self, name: str) -> Value:
        """Read a setting.

        Args:
            name: Its name or alias.

        Returns:
            The value, in the unit of the definition.

        Raises:
            InvalidArgumentError: There is no such setting.
            MspFirmwareError: The firmware, or its version, does not have it.
            MspError: The flight controller does not answer, or refuses.
        """
        definition = self.definition(name)
        message = await self._controller.get(definition.read)
        value = definition.value_in(message)
        if value is None:
            raise MspSettingError(
                f"reading {name} of", self._controller.name, answer="the firmware does not send it"
            )
        return value

    async def all(self, progress: Callable[[int, int], None] | None = None) -> dict[str, Value]:
        """Read all settings.

        Args:
            progress: Called with the number of messages that were read, and of all.

        Returns:
            The values by name, in the units of the definitions; without those of equipment that the flight
            controller does not have.

        Raises:
            MspError: The flight controller does not answer.
        """
        settings = self._current()
        reads = settings.reads()
        messages: dict[type[MspMessage], MspMessage] = {}
        for count, kind in enumerate(reads, 1):
            with suppress(MspDenied):  # a target without this equipment refuses the command
                messages[kind] = await self._controller.get(kind, priority=Priority.BACKGROUND)
            if progress is not None:
                progress(count, len(reads))
        return settings.values(messages)

    async def set(self, name: str, value: Value) -> Value:
        """Write a setting, and read it back.

        Args:
            name: Its name or alias.
            value: The new value, in the unit of the definition.

        Returns:
            The value that was read back, which may be rounded.

        Raises:
            InvalidArgumentError: There is no such setting, or the value is outside its range.
            MspFirmwareError: The firmware, or its version, does not have the setting.
            MspSettingError: The flight controller took the message and has another value afterwards.
            MspError: The flight controller does not answer, or refuses.
        """
        definition = self.definition(name)
        wanted = definition.checked(value)
        async with self._changing:  # another call may change other settings of the same message
            current: TableMessage = await self._controller.get(definition.read)
            await self._controller.send(self._current().change(current, name, wanted))
            now = definition.value_in(await self._controller.get(definition.read))
        if now is None or not definition.is_equal(now, wanted):
            answer = f"wrote {wanted:g}, read {'nothing' if now is None else f'{now:g}'} back"
            raise MspSettingError(f"writing {name} of", self._controller.name, answer=answer)
        return now

    async def save(self) -> None:
        """Save all settings, so that they are there after a restart.

        Raises:
            MspDenied: The vehicle is armed.
            MspTimeout: No reply came in time.
        """
        await self._controller.save()

    def _current(self) -> Settings:
        if self._settings is None or self._settings.firmware != self._controller.info:
            self._settings = Settings(self._controller.info, self._controller.name)
        return self._settings
