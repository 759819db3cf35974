"""A simulated pilot that performs the steps of a calibration."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.vehicle import CalibrationResult, CalibrationStep, Vehicle


async def calibrate(
    vehicle: Vehicle, kind: str, act: Callable[[CalibrationStep], None] | None = None, **options: float
) -> tuple[list[CalibrationStep], CalibrationResult]:
    """Run a calibration, and confirm each step that needs it after two seconds; return steps and result."""
    steps: list[CalibrationStep] = []
    asked: list[str] = []
    async with vehicle.calibration.start(kind, **options) as session:
        async for step in session:
            steps.append(step)
            if act is not None:
                act(step)
            if step.needs_confirmation and (not asked or asked[-1] != f"{step.task} {step.pose}"):
                asked.append(f"{step.task} {step.pose}")
                await asyncio.sleep(2.0)
                await session.confirm()
        assert session.result is not None
        return steps, session.result
