"""The calibrations that run: at most one for each vehicle, confirmed and cancelled by other requests."""

from __future__ import annotations

import asyncio
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from mavstack.http.bodies import RefusedError
from mavstack.server.json_values import to_json

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.vehicle import CalibrationResult, CalibrationSession, Vehicle

    #: Called with each step, as JSON.
    OnStep = Callable[[dict[str, Any]], None]


@dataclass(slots=True)
class _Running:
    """A calibration that runs."""

    session: CalibrationSession
    task: asyncio.Task[CalibrationResult | None]


class Calibrations:
    """The calibrations of a station by the system id of the vehicle."""

    def __init__(self) -> None:
        self._running: dict[int, _Running] = {}

    async def run(
        self,
        vehicle: Vehicle,
        kind: str,
        on_step: OnStep,
        *,
        timeout: float | None = None,  # noqa: ASYNC109 (it is that of the vehicle's calibration)
    ) -> CalibrationResult | None:
        """Run a calibration to its end.

        Args:
            vehicle: The vehicle.
            kind: The kind, such as "accelerometer".
            on_step: Called with each step.
            timeout: Seconds for the whole calibration; None: no limit.

        Returns:
            The result.

        Raises:
            RefusedError: Another calibration of the vehicle runs, or this one was cancelled.
            InvalidArgumentError: There is no such kind.
            ActionUnsupported: The vehicle lacks it.
            RemoteError: The calibration failed.
        """
        known = self._running.get(vehicle.system)
        if known is not None:
            raise RefusedError(
                409, f"the {known.session.kind} calibration of vehicle {vehicle.system} runs already"
            )
        session = vehicle.calibration.start(kind, timeout=timeout)
        task = asyncio.get_running_loop().create_task(_follow(session, on_step))
        running = self._running[vehicle.system] = _Running(session, task)
        try:
            await asyncio.wait([task])
        finally:
            task.cancel()  # has an effect only if this request was cancelled
            await asyncio.gather(task, return_exceptions=True)
            self._remove(vehicle.system, running)
        if task.cancelled():
            raise RefusedError(409, f"the {kind} calibration of vehicle {vehicle.system} was cancelled")
        return task.result()

    def session(self, system: int, kind: str | None = None) -> CalibrationSession | None:
        """Return the calibration of a vehicle that runs, of one kind or any; None if there is none."""
        known = self._running.get(system)
        return None if known is None or kind not in (None, known.session.kind) else known.session

    async def cancel(self, vehicle: Vehicle, kind: str) -> None:
        """Cancel a calibration: the one that runs here, or one that another program has started."""
        if self.session(vehicle.system, kind) is None:
            await vehicle.calibration.cancel(kind)
            return
        running = self._running[vehicle.system]
        running.task.cancel()
        await asyncio.wait([running.task])
        # Remove it before the answer, so that the client can start the next calibration right away.
        self._remove(vehicle.system, running)

    def _remove(self, system: int, running: _Running) -> None:
        if self._running.get(system) is running:
            del self._running[system]


def step_json(session: CalibrationSession) -> dict[str, Any] | None:
    """Return the last step of a calibration as JSON; None before the first one."""
    step = session.step
    return None if step is None else dict(to_json(step))


async def _follow(session: CalibrationSession, on_step: OnStep) -> CalibrationResult | None:
    async with session:
        async for step in session:
            on_step(to_json(step))
        return session.result
