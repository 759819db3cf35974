"""All messages, and which of them stands behind a command in each direction."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

from mavstack.msp.firmware_info import BETAFLIGHT, INAV, FirmwareInfo
from mavstack.msp.messages import (
    actions,
    battery,
    blackbox,
    config,
    filters,
    gps,
    led_strip,
    modes,
    motors,
    navigation,
    osd,
    pid,
    rc,
    sensors,
    status,
    vtx,
)
from mavstack.msp.messages.layout import TableMessage

if TYPE_CHECKING:
    from collections.abc import Iterator
    from types import ModuleType

AREAS: tuple[ModuleType, ...] = (
    status,
    sensors,
    gps,
    battery,
    rc,
    modes,
    motors,
    pid,
    filters,
    config,
    osd,
    vtx,
    blackbox,
    led_strip,
    navigation,
    actions,
)
"""Modules with messages, in the order of the reference."""


def messages_of(area: ModuleType) -> tuple[type[TableMessage], ...]:
    """Return the messages that a module defines, in its order."""
    return tuple(_messages_in(area))


@cache
def all_messages() -> tuple[type[TableMessage], ...]:
    """Return all messages, area by area."""
    return tuple(message for area in AREAS for message in _messages_in(area))


def reply_type(command: int, firmware: FirmwareInfo | None = None) -> type[TableMessage] | None:
    """Return the message that a flight controller sends for a command; None if none is defined.

    Args:
        command: The number of the command.
        firmware: The flight controller's; None means Betaflight.
    """
    found = _types(command, _variant(firmware), is_reply=True)
    return found[0] if found else None


def request_types(command: int, firmware: FirmwareInfo | None = None) -> tuple[type[TableMessage], ...]:
    """Return the messages that a flight controller receives with a command, most have one.

    Args:
        command: The number of the command.
        firmware: The flight controller's; None means Betaflight.
    """
    return _types(command, _variant(firmware), is_reply=False)


@cache
def _types(command: int, variant: str, *, is_reply: bool) -> tuple[type[TableMessage], ...]:
    return tuple(
        message
        for message in all_messages()
        if command == message.COMMAND and is_reply == message.IS_REPLY and variant in message.VARIANTS
    )


def _variant(firmware: FirmwareInfo | None) -> str:
    return INAV if firmware is not None and firmware.is_inav else BETAFLIGHT


def _messages_in(area: ModuleType) -> Iterator[type[TableMessage]]:
    for value in vars(area).values():
        if isinstance(value, type) and issubclass(value, TableMessage) and value.__module__ == area.__name__:
            yield value
