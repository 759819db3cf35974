"""The calibrations of a vehicle: `vehicle.calibration`.

    await vehicle.calibration.run("gyroscope")

    async with vehicle.calibration.start("accelerometer") as calibration:
        async for step in calibration:
            print(step)
            if step.needs_confirmation:
                await calibration.confirm()

ArduPilot and PX4 hold different conversations; the steps are the same. ArduPilot asks for one pose after the
other and waits for a confirmation; PX4 detects by itself which of the pending sides is down.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.errors import InvalidArgumentError
from mavstack.node.api_object import ReadOnly
from mavstack.vehicle.calibration.kinds import CalibrationKind, CalibrationResult
from mavstack.vehicle.calibration.selection import procedures_of
from mavstack.vehicle.calibration.session import CalibrationSession
from mavstack.vehicle.deadline import deadline
from mavstack.vehicle.firmware import firmware_of
from mavstack.vehicle.status_text_capture import with_status_texts

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.vehicle.calibration.kinds import CalibrationStep
    from mavstack.vehicle.calibration.procedure import Procedure
    from mavstack.vehicle.vehicle import Vehicle


class Calibration(ReadOnly):
    """The calibrations of a vehicle; `vehicle.calibration`."""

    def __init__(self, vehicle: Vehicle) -> None:
        self._vehicle = vehicle

    @property
    def kinds(self) -> tuple[CalibrationKind, ...]:
        """The kinds that the firmware and the vehicle type have."""
        return tuple(procedures_of(self._vehicle))

    def needs_confirmation(self, kind: CalibrationKind | str) -> bool:
        """Return whether steps of a calibration wait for a confirmation, as of poses and sticks.

        Args:
            kind: The kind, or its name such as "accelerometer".

        Returns:
            True if `start` is needed for it; `run` cannot confirm steps.

        Raises:
            InvalidArgumentError: There is no such kind.
            ActionUnsupported: The firmware or the vehicle type lacks it.
        """
        return self._procedure(kind)[1].needs_confirmation

    def can_cancel(self, kind: CalibrationKind | str) -> bool:
        """Return whether the vehicle can cancel a calibration that runs.

        PX4 cancels all of them. ArduPilot cancels those of compasses, motors and the radio control; the
        others end by themselves, and its accelerometer calibration goes on at its next start. Betaflight
        and iNav cancel none.

        Args:
            kind: The kind, or its name such as "accelerometer".

        Returns:
            True if `cancel`, or leaving the block of `start`, ends it on the vehicle.

        Raises:
            InvalidArgumentError: There is no such kind.
            ActionUnsupported: The firmware or the vehicle type lacks it.
        """
        return self._procedure(kind)[1].can_cancel

    def start(self, kind: CalibrationKind | str, *, timeout: float | None = None) -> CalibrationSession:
        """Return a context manager during which a calibration runs, and an async iterator of its steps.

        The vehicle must be disarmed. Leaving the block before the end cancels the calibration, as far as the
        firmware can: ArduPilot cannot cancel its accelerometer calibration, which a new start continues.

        Args:
            kind: The kind, or its name such as "accelerometer".
            timeout: Seconds for the whole calibration; None sets no overall limit.

        Returns:
            The session. Its iteration raises `CommandDenied`, `CommandTimeout`, `ActionTimeout`,
            `ActionInterrupted`, `ContactLost` or `RemoteCancelled` if the calibration fails.

        Raises:
            InvalidArgumentError: There is no such kind.
            ActionUnsupported: The firmware or the vehicle type lacks it.
        """
        found, procedure = self._procedure(kind)
        return CalibrationSession(self._vehicle, found, procedure, timeout)

    async def run(
        self,
        kind: CalibrationKind | str,
        *,
        on_step: Callable[[CalibrationStep], None] | None = None,
        timeout: float | None = None,
    ) -> CalibrationResult:
        """Run a calibration that needs no confirmation to its end.

        Args:
            kind: The kind, or its name such as "gyroscope".
            on_step: Called with each step, which tells what to do with the vehicle.
            timeout: Seconds for the whole call; None: until the vehicle gives no sign of progress.

        Returns:
            The result.

        Raises:
            InvalidArgumentError: There is no such kind, or its steps need confirmations; use `start`.
            ActionUnsupported: The firmware or the vehicle type lacks it; nothing was sent.
            CommandDenied: The vehicle refused, such as while it is armed.
            CommandTimeout: The vehicle did not answer.
            ActionTimeout: It was not done within `timeout`, or the vehicle gave no sign of progress.
            ActionInterrupted: The vehicle reported that it failed, or was armed meanwhile.
            ContactLost: No heartbeat of the vehicle arrives.
            RemoteCancelled: The connection was closed.
        """
        if self.needs_confirmation(kind):
            raise InvalidArgumentError(
                f"the {kind} calibration needs confirmations; use start() and confirm()"
            )
        async with self.start(kind, timeout=timeout) as session:
            async for step in session:
                if on_step is not None:
                    on_step(step)
            return session.result or CalibrationResult(session.kind)

    async def cancel(self, kind: CalibrationKind | str, *, timeout: float | None = None) -> None:
        """Cancel a calibration that another program, or an earlier one, has started.

        Args:
            kind: The kind, or its name.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            InvalidArgumentError: There is no such kind.
            ActionUnsupported: The firmware or the vehicle type lacks it; nothing was sent.
            CommandDenied: The vehicle refused.
            CommandTimeout: The vehicle did not answer.
            ActionTimeout: The call did not end within `timeout`.
        """
        found, procedure = self._procedure(kind)
        async with deadline(timeout, f"cancelling the {found} calibration of", self._vehicle.address):
            await with_status_texts(self._vehicle, procedure.cancel(self._vehicle))

    def _procedure(self, kind: CalibrationKind | str) -> tuple[CalibrationKind, Procedure]:
        try:
            found = CalibrationKind(kind)
        except ValueError:
            names = ", ".join(CalibrationKind)
            raise InvalidArgumentError(f"there is no calibration {kind!r}; there are {names}") from None
        procedure = procedures_of(self._vehicle).get(found)
        if procedure is None:
            firmware = firmware_of(self._vehicle)
            reason = f"as a {self._vehicle.vehicle_type} with this firmware it has no such calibration"
            raise firmware.unsupported(f"run the {found} calibration", reason)
        return found, procedure
