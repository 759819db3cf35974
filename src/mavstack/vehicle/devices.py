"""Devices of a vehicle that report about themselves: `vehicle.devices`.

    async with vehicle.devices.stream_escs() as escs:
        async for state in escs:
            print({number: esc.rpm for number, esc in state.items()})

A value is the last one that was received; nothing is sent for it. A stream requests its messages.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from mavstack.dialects import common
from mavstack.node.api_object import ReadOnly
from mavstack.vehicle.telemetry import readers
from mavstack.vehicle.telemetry.value_stream import ValueStream

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.dialects import Message
    from mavstack.vehicle.telemetry import values
    from mavstack.vehicle.vehicle import Vehicle
    from mavstack.wire import Packet

_MAX_INSTANCES: Final = 16


class Devices(ReadOnly):
    """Motor controllers, generator, engine and modems of a vehicle."""

    def __init__(self, vehicle: Vehicle) -> None:
        self._telemetry = vehicle.telemetry
        self._messages: dict[type[Message], dict[int, Any]] = {}
        for kind, field in (
            (common.EscStatus, "index"),
            (common.EscInfo, "index"),
            (common.CellularStatus, "id"),
        ):
            self._follow(vehicle, kind, field)

    @property
    def escs(self) -> Mapping[int, values.Esc]:
        """The motor controllers by number, from 1: rpm, volts, amperes (ESC_STATUS, ESC_TELEMETRY_1_TO_4)."""
        statuses, infos = self._messages[common.EscStatus], self._messages[common.EscInfo]
        return readers.read_escs(self._telemetry, statuses, infos)

    @property
    def generator(self) -> values.Generator | None:
        """The generator: rpm, watts, volts, amperes, degrees Celsius (GENERATOR_STATUS)."""
        return readers.read_generator(self._telemetry)

    @property
    def engine(self) -> values.Engine | None:
        """The combustion engine: rpm, percent, cm³, degrees Celsius (EFI_STATUS)."""
        return readers.read_engine(self._telemetry)

    @property
    def modems(self) -> Mapping[int, values.Modem]:
        """The modems of mobile networks by id: state, and quality in percent (CELLULAR_STATUS)."""
        messages = self._messages[common.CellularStatus]
        return {number: readers.read_modem(message) for number, message in sorted(messages.items())}

    def stream_escs(self, rate: float | None = None) -> ValueStream[Mapping[int, values.Esc]]:
        """Stream the motor controllers by number (ESC_STATUS, ESC_INFO, or ESC_TELEMETRY_1_TO_4).

        Args:
            rate: Hertz; None: as the vehicle sends it, or a default rate.

        Returns:
            The stream.
        """
        kinds = (common.EscStatus, common.EscInfo, *readers.ESC_TELEMETRY[:1])
        return ValueStream(self._telemetry, lambda _: self.escs or None, kinds, rate)

    def stream_generator(self, rate: float | None = None) -> ValueStream[values.Generator]:
        """Stream the generator (GENERATOR_STATUS).

        Args:
            rate: Hertz; None: as the vehicle sends it, or a default rate.

        Returns:
            The stream.
        """
        return ValueStream(self._telemetry, readers.read_generator, (common.GeneratorStatus,), rate)

    def stream_engine(self, rate: float | None = None) -> ValueStream[values.Engine]:
        """Stream the combustion engine (EFI_STATUS).

        Args:
            rate: Hertz; None: as the vehicle sends it, or a default rate.

        Returns:
            The stream.
        """
        return ValueStream(self._telemetry, readers.read_engine, (common.EfiStatus,), rate)

    def stream_modems(self, rate: float | None = None) -> ValueStream[Mapping[int, values.Modem]]:
        """Stream the modems by id (CELLULAR_STATUS).

        Args:
            rate: Hertz; None: as the vehicle sends it, or a default rate.

        Returns:
            The stream.
        """
        return ValueStream(self._telemetry, lambda _: self.modems or None, (common.CellularStatus,), rate)

    def _follow(self, vehicle: Vehicle, kind: type[Message], field: str) -> None:
        """Keep the last message of each instance, beginning with the last one that was received."""
        found = self._messages[kind] = {}

        def keep(message: Message) -> None:
            number = getattr(message, field)
            if number in found or len(found) < _MAX_INSTANCES:
                found[number] = message

        def receive(packet: Packet) -> None:
            keep(packet.message)

        last = vehicle.telemetry.latest(kind)
        if last is not None:
            keep(last)
        vehicle.connection.add_packet_listener(kind, receive, system=vehicle.system)
