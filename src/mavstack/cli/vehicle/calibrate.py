"""`mav vehicle calibrate`: one calibration, with its steps on the terminal.

Enter confirms a step that waits for it; `--yes` confirms it after a pause, for scripts. Without a kind the
command lists the kinds that the vehicle has.
"""

from __future__ import annotations

import asyncio
import sys
from typing import TYPE_CHECKING, Any, Final

from mavstack.cli.common.confirmation import add_yes_option
from mavstack.cli.common.connection import run_on_vehicle
from mavstack.cli.common.errors import UsageError
from mavstack.cli.common.options import finite_number
from mavstack.cli.common.output import echo, echo_json, echo_progress
from mavstack.cli.common.selection import of_vehicle
from mavstack.cli.common.stdin_lines import stdin_lines
from mavstack.cli.vehicle.arguments import add_timed
from mavstack.vehicle import CalibrationKind

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Awaitable, Callable, Coroutine

    from mavstack.cli.common.actions import Actions
    from mavstack.vehicle import CalibrationResult, CalibrationSession, CalibrationStep, Vehicle

    Ask = Callable[[str], Awaitable[str]]

#: Seconds after which `--yes` confirms a step.
DEFAULT_PAUSE: Final = 5.0


def add_actions(actions: Actions) -> None:
    """Declare the action."""
    summary = "calibrate a sensor, the radio control or the motors"
    action = add_timed(actions, "calibrate", summary, calibrate, fleet=False)
    action.add_argument(
        "kind", nargs="?", choices=[kind.value for kind in CalibrationKind], metavar="KIND", help=_KINDS
    )
    action.add_argument("--cancel", action="store_true", help="cancel the calibration that runs")
    action.add_argument(
        "--pause",
        type=finite_number,
        default=DEFAULT_PAUSE,
        metavar="SECONDS",
        help=f"time before --yes confirms a step (default: {DEFAULT_PAUSE:g})",
    )
    add_yes_option(action)


_KINDS: Final = f"{', '.join(CalibrationKind)}; without it list those of the vehicle"


def calibrate(arguments: Namespace) -> int:
    """Run `mav vehicle calibrate`."""
    kind = None if arguments.kind is None else CalibrationKind(arguments.kind)
    if arguments.cancel and kind is None:
        raise UsageError("--cancel needs the kind of the calibration")

    async def work(vehicle: Vehicle) -> int:
        if kind is None:
            _list_kinds(vehicle, arguments)
            return 0
        if arguments.cancel:
            await vehicle.calibration.cancel(kind, timeout=arguments.action_timeout)
            _report(vehicle, arguments, kind, f"{kind} calibration cancelled")
            return 0
        return await _run(vehicle, kind, arguments)

    return run_on_vehicle(arguments, work)


def _list_kinds(vehicle: Vehicle, arguments: Namespace) -> None:
    kinds = vehicle.calibration.kinds
    if arguments.json:
        echo_json({"system": vehicle.system, "kinds": list(kinds)})
    else:
        echo(*(kinds or [of_vehicle(vehicle, "no calibration is known for its firmware")]))


async def _run(vehicle: Vehicle, kind: CalibrationKind, arguments: Namespace) -> int:
    questions = _Questions(arguments)
    if vehicle.calibration.needs_confirmation(kind) and not questions.can_be_asked:
        text = f"the {kind} calibration asks questions; add --yes to answer each after --pause seconds"
        raise UsageError(text)
    display, asked, answers = _Display(arguments), "", _Answers()
    try:
        async with vehicle.calibration.start(kind, timeout=arguments.action_timeout) as session:
            async for step in session:
                question = f"{step.task} {step.pose}" if step.needs_confirmation else ""
                display.show(step)
                if question and question != asked:
                    answers.begin(_confirm(questions, session, step))
                asked = question
    finally:
        await answers.end()
        display.end()
    _report_result(vehicle, arguments, session.result)
    return 0


async def _confirm(questions: _Questions, session: CalibrationSession, step: CalibrationStep) -> None:
    await questions.ask(step)
    await session.confirm()


class _Answers:
    """The question that is open; steps go on to arrive meanwhile."""

    def __init__(self) -> None:
        self._task: asyncio.Task[None] | None = None

    def begin(self, asking: Coroutine[Any, Any, None]) -> None:
        """Ask a question."""
        self._task = asyncio.get_running_loop().create_task(asking)

    async def end(self) -> None:
        """Withdraw the open question."""
        if self._task is not None:
            self._task.cancel()
            await asyncio.gather(self._task, return_exceptions=True)


class _Questions:
    """Asks the user, in the shell by its own prompt, or waits for the pause of `--yes`."""

    def __init__(self, arguments: Namespace) -> None:
        self._pause = arguments.pause if arguments.yes else None
        self._prompt: Ask | None = getattr(arguments, "ask", None)
        self._in_session = hasattr(arguments, "session_work")
        self._lines = stdin_lines()

    @property
    def can_be_asked(self) -> bool:
        """True if the user, or `--yes`, can answer."""
        terminal = sys.stdin.isatty() and not self._in_session
        return self._pause is not None or self._prompt is not None or terminal

    async def ask(self, step: CalibrationStep) -> None:
        """Wait until the task of a step is done."""
        if self._pause is not None:
            await asyncio.sleep(self._pause)
        elif self._prompt is not None:
            await self._prompt("[Enter] ")
        else:
            await anext(self._lines, "")


class _Display:
    """Shows steps: a line for each new task, and their progress in one line on a terminal."""

    def __init__(self, arguments: Namespace) -> None:
        self._json = arguments.json
        self._live = sys.stderr.isatty() and not arguments.json
        self._shown = ""

    def show(self, step: CalibrationStep) -> None:
        """Show a step: its task once, and its text or its progress as it changes."""
        if self._json:
            echo_json(_plain(step))
            return
        task = f"{step.task} {step.pose}" if step.needs_confirmation else step.text
        if task != self._shown:
            self._shown = task
            self.end()
            echo(step.text)
        elif self._live:
            echo_progress(str(step))

    def end(self) -> None:
        """Erase the progress line."""
        if self._live:
            echo_progress("")


def _plain(step: CalibrationStep) -> dict[str, Any]:
    """Return a step as values for JSON."""
    return {
        "kind": step.kind,
        "task": step.task,
        "text": step.text,
        "pose": step.pose,
        "pending": list(step.pending),
        "progress": step.progress,
        "needs_confirmation": step.needs_confirmation,
    }


def _report_result(vehicle: Vehicle, arguments: Namespace, result: CalibrationResult | None) -> None:
    if result is None:
        return
    text = f"{result.kind} calibration done"
    for compass in result.compasses:
        text += f", compass {compass.id} within {compass.fitness:.1f} mG"
    if result.channels:
        text += f", channels {', '.join(map(str, result.channels))}"
    if result.reboot_needed:
        text += "; reboot the vehicle"
    _report(vehicle, arguments, result.kind, text, reboot_needed=result.reboot_needed)


def _report(
    vehicle: Vehicle, arguments: Namespace, kind: CalibrationKind, text: str, *, reboot_needed: bool = False
) -> None:
    if arguments.json:
        facts = {"system": vehicle.system, "action": arguments.action, "kind": kind, "ok": True, "text": text}
        echo_json({**facts, "reboot_needed": reboot_needed})
    else:
        echo(of_vehicle(vehicle, text))
