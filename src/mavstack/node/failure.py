"""Failures injected into a remote vehicle, for tests of its failsafes: `component.failure`.

    await component.failure.inject("gps", "off")
    await component.failure.inject("motor", "off", instance=2)
    await component.failure.inject("gps", "ok")

PX4 accepts them while its parameter SYS_FAILURE_EN is 1. Which failures of a unit have an effect depends on
the vehicle; ArduPilot has none.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.node.api_object import ReadOnly
from mavstack.services.command import Command, CommandOperation

if TYPE_CHECKING:
    from mavstack.node.clients import ComponentClients

#: The largest number of a unit.
MAX_INSTANCE: Final = 255


def failure_units() -> dict[str, common.FailureUnit]:
    """Return the units that may fail, by their names, such as "gps" and "rc_signal"."""
    return {unit.name.split("_", 1)[1].lower(): unit for unit in common.FailureUnit}


def failure_types() -> dict[str, common.FailureType]:
    """Return the ways to fail, by their names, such as "off"; "ok" ends a failure."""
    return {each.name.lower(): each for each in common.FailureType}


class Failure(ReadOnly):
    """Failures that the vehicle simulates on purpose (MAV_CMD_INJECT_FAILURE)."""

    def __init__(self, clients: ComponentClients) -> None:
        self._clients = clients

    async def inject(
        self, unit: str, failure: str = "off", instance: int = 0, *, timeout: float | None = None
    ) -> None:
        """Make a unit of the vehicle fail, or end its failure (MAV_CMD_INJECT_FAILURE).

        Args:
            unit: The unit: gyro, accel, mag, baro, gps, optical_flow, vio, distance_sensor, airspeed,
                battery, motor, servo, avoidance, rc_signal, mavlink_signal, esc or traffic_avoidance.
            failure: The way to fail: off, stuck, garbage, wrong, slow, delayed, intermittent or drift; ok
                ends the failure.
            instance: The number of the unit, from 1; 0: all of them.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            InvalidArgumentError: There is no such unit or way to fail, or the number is out of range.
            CommandDenied: The vehicle does not simulate this failure, or SYS_FAILURE_EN is 0.
            CommandTimeout: The vehicle does not answer.
        """
        number = _chosen("unit", unit, failure_units())
        kind = _chosen("failure", failure, failure_types())
        if not 0 <= instance <= MAX_INSTANCE:
            raise InvalidArgumentError(f"instance must be from 0 to {MAX_INSTANCE}, got {instance}")
        host = self._clients.host
        params = (float(number), float(kind), float(instance))
        command = Command.of(host.named_command(common.MavCmd.INJECT_FAILURE), params, None)
        await host.run_operation(self._clients.command, CommandOperation(command, timeout=timeout))


def _chosen(
    what: str, name: str, known: dict[str, common.FailureUnit] | dict[str, common.FailureType]
) -> int:
    number = known.get(name.strip().lower().replace("-", "_").replace(" ", "_"))
    if number is None:
        raise InvalidArgumentError(f"there is no {what} {name!r}; there are: {', '.join(known)}")
    return int(number)
