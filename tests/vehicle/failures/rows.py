"""The rows of the failure table: for each call, how the vehicle refuses it and the error that follows, and
the errors for a silent vehicle and for one that accepts and does nothing. Where a call cannot fail in one of
these ways, its row holds the reason.
"""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from mavstack.dialects import ardupilotmega, common
from mavstack.errors import (
    CommandDenied,
    CommandTimeout,
    FileDenied,
    FileTimeout,
    MissionDenied,
    MissionTimeout,
    ModeTimeout,
    RemoteDenied,
    RemoteError,
)
from mavstack.services.mission import MissionItem
from tests.vehicle.failures.scripted_autopilot import CMD, RESULT, ScriptedHarness

Do = Callable[[ScriptedHarness], Awaitable[Any]]

MISSION_RESULT, FTP, PARAM = common.MavMissionResult, common.MavFtpErr, common.MavParamError
#: The answers of a firmware that knows a command and refuses it.
CODES = (RESULT.DENIED, RESULT.TEMPORARILY_REJECTED, RESULT.FAILED, RESULT.UNSUPPORTED)
#: After UNSUPPORTED an older request follows.
FALLING_BACK = CODES[:3]
ITEMS = [MissionItem(CMD.NAV_WAYPOINT, param5=47.4, param6=8.55, param7=20.0) for _ in range(8)]
PLACE = (47.3990, 8.5470, 25.0)


@dataclass(frozen=True)
class Call:
    """One call: `do` makes it, and the other attributes describe its failures."""

    name: str
    do: Do
    #: The operation in the error.
    operation: str = ""
    refuse: Callable[[ScriptedHarness, int], None] | None = None
    denied: type[RemoteDenied] = CommandDenied
    codes: tuple[int, ...] = CODES
    #: True if a refusal waits for a reason that follows it.
    waits: bool = True
    #: The error for a silent vehicle.
    silent: type[RemoteError] | None = CommandTimeout
    #: The error, and a part of its text, for a vehicle that accepts and does nothing.
    stuck: tuple[type[RemoteError], str] | None = None
    #: True if the call ends when the vehicle does something else.
    interrupted: bool = False
    #: The preparation before the call.
    before: Do | None = None
    armed: bool = True
    #: `autopilot` and `kind` of the scripted autopilot, if it is not a PX4 quadrotor.
    options: Mapping[str, int] = field(default_factory=dict)
    #: The reason for each kind of failure that is missing.
    why_not: str = ""


def command(
    name: str, do: Do, number: int, *, operation: str = "", codes: tuple[int, ...] = CODES, **more: Any
) -> Call:
    """Return the row of a call that sends a command; its errors name the command, or the operation."""
    operation = operation or ardupilotmega.MavCmd(number).official_name.removeprefix("MAV_CMD_")

    def refuse(harness: ScriptedHarness, code: int) -> None:
        harness.autopilot.refuse(number, result=code)

    return Call(name, do, operation, refuse, codes=codes, **more)


def rate(name: str, do: Do, hertz: int, **more: Any) -> Call:
    """Return the row of a call that requests a message rate."""

    def refuse(harness: ScriptedHarness, code: int) -> None:
        harness.autopilot.refuse(CMD.SET_MESSAGE_INTERVAL, result=code)

    operation = f"ATTITUDE at {hertz} Hz"
    return Call(name, do, operation, refuse, codes=FALLING_BACK, waits=False, **more)


def mode(name: str, do: Do, **more: Any) -> Call:
    """Return the row of a call that sets a mode."""
    more = {"silent": ModeTimeout, "stuck": (ModeTimeout, "accepted, but not entered")} | more
    return command(name, do, CMD.DO_SET_MODE, codes=FALLING_BACK, **more)


def plan(name: str, do: Do, operation: str, **more: Any) -> Call:
    """Return the row of a call that transfers a plan."""
    codes = (MISSION_RESULT.DENIED, MISSION_RESULT.UNSUPPORTED_FRAME, MISSION_RESULT.INVALID_PARAM5_X)

    def refuse(harness: ScriptedHarness, code: int) -> None:
        harness.autopilot.refuse_plans(code)

    base: dict[str, Any] = {
        "refuse": refuse,
        "denied": MissionDenied,
        "codes": codes,
        "silent": MissionTimeout,
    }
    return Call(name, do, operation, **base | more)


def no_plan(harness: ScriptedHarness, code: int) -> None:
    harness.autopilot.mission.limits.clear()


def file(name: str, do: Do, operation: str, code: int | None = FTP.FILENOTFOUND, **more: Any) -> Call:
    """Return the row of a call on a file that does not exist or must not be changed."""
    if code is None:
        return Call(name, do, operation, silent=FileTimeout, **more)
    return Call(name, do, operation, nothing, FileDenied, (code,), waits=False, silent=FileTimeout, **more)


def nothing(harness: ScriptedHarness, code: int) -> None:
    """Change nothing: the vehicle refuses the request anyway."""


def read_only(harness: ScriptedHarness, code: int) -> None:
    harness.autopilot.parameters.table["P_00"].read_only = True


def keeps_logs(harness: ScriptedHarness, code: int) -> None:
    harness.autopilot.logs.erase = lambda: None


def call_name(call: Call) -> str:
    return call.name
