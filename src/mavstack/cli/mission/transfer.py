"""The actions of `mav mission` on a vehicle: upload, download and clear plans, start the mission.

Several plans are uploaded one after the other, the mission last, because it must not be flown without the
fence that was made for it. The outcome of each plan is shown, also when one is refused and the others are not
sent. A fence or rally points that the firmware does not support at all do not keep the mission from being
sent; the command says so, and fails unless the plans are named.
"""

from __future__ import annotations

from math import isnan
from typing import TYPE_CHECKING, Any, Final

from mavstack.cli.common.connection import on_vehicle, run_on_vehicle
from mavstack.cli.common.errors import CommandError
from mavstack.cli.common.output import echo
from mavstack.cli.common.selection import of_vehicle
from mavstack.cli.common.transfer_progress import TransferProgress
from mavstack.cli.mission.files import STANDARD, read, save, select_plan_types, validate
from mavstack.cli.vehicle.interruption import notice_of_interruption
from mavstack.dialects import common
from mavstack.errors import ActionUnsupported, MavstackError, MissionDenied, RemoteError, RemoteProtocolError
from mavstack.files.plans import Home, PlanFile, Settings, format_of
from mavstack.files.plans.model import PLAN_NAMES, params_of
from mavstack.services.mission import Plan, PlanType
from mavstack.services.mission.server import NO_MISSION

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Callable, Collection, Coroutine, Sequence

    from mavstack.services.mission import MissionItem
    from mavstack.vehicle import Vehicle
    from mavstack.vehicle.mission import VehiclePlan

#: The order in which plans are uploaded and cleared.
ORDER: Final = (PlanType.FENCE, PlanType.RALLY, PlanType.MISSION)
#: Seconds to wait for a requested message that not all vehicles support.
OPTIONAL_MESSAGE_TIMEOUT: Final = 2.0
#: Tolerances of a comparison in degrees, in metres and relative, since vehicles round the numbers.
PLACE_STEP: Final = 2e-7
ALTITUDE_STEP: Final = 0.01
RELATIVE_STEP: Final = 1e-5


def upload(arguments: Namespace) -> int:
    """Run `mav mission upload`."""
    name, plan = read(arguments.file)
    chosen = select_plan_types(plan, arguments.plan_types, name)
    if not arguments.force:
        validate(plan.only(chosen), name)
    for note in plan.notes:
        echo(f"mav mission: note: {note}", error=True)

    async def work(vehicle: Vehicle) -> int:
        unsupported: list[PlanType] = []

        async def act(plan_type: PlanType) -> None:
            try:
                await _upload(vehicle, plan, plan_type, verify=arguments.verify)
            except (ActionUnsupported, MissionDenied) as error:
                if arguments.plan_types or plan_type == PlanType.MISSION or not _is_unsupported(error):
                    raise
                unsupported.append(plan_type)
                echo(of_vehicle(vehicle, f"{PLAN_NAMES[plan_type]}: not sent, the firmware has none"))

        await _each(vehicle, chosen, "not sent", act)
        if unsupported:
            raise CommandError(_partly_sent(vehicle, chosen, unsupported))
        return 0

    return run_on_vehicle(arguments, work)


def _is_unsupported(error: ActionUnsupported | MissionDenied) -> bool:
    """Return whether the firmware has no plans of this type, and not only refuses this one."""
    return isinstance(error, ActionUnsupported) or error.code == common.MavMissionResult.UNSUPPORTED


def _partly_sent(vehicle: Vehicle, chosen: Collection[PlanType], unsupported: Sequence[PlanType]) -> str:
    missing = " and the ".join(PLAN_NAMES[each] for each in unsupported)
    sent = [each for each in ORDER if each in chosen and each not in unsupported]
    if not sent:
        return f"vehicle {vehicle.system} does not support the {missing}: nothing was sent"
    options = " ".join(f"--{each.name.lower()}" for each in sent)
    names = " and the ".join(PLAN_NAMES[each] for each in sent)
    return (
        f"vehicle {vehicle.system} does not support the {missing}; sent without: the {names} "
        f"(with {options} the others are not tried, and this is no error)"
    )


def download(arguments: Namespace) -> int:
    """Run `mav mission download`."""
    to_file = arguments.file != STANDARD
    name = arguments.format or (format_of(arguments.file) if to_file else None)
    plan_types = tuple(dict.fromkeys(arguments.plan_types or _plan_types_of_format(name)))

    async def work(vehicle: Vehicle) -> int:
        strict = bool(arguments.plan_types) or len(plan_types) == 1
        plan = await download_plans(vehicle, plan_types, strict=strict)
        save(plan, arguments.file, name, force=arguments.force)
        if to_file:
            counts = ", ".join(f"{PLAN_NAMES[each]}: {_count(plan, each)}" for each in plan_types)
            echo(f"{arguments.file}: {counts}")
        return 0

    return run_on_vehicle(arguments, work)


def clear(arguments: Namespace) -> int:
    """Run `mav mission clear`."""
    chosen = arguments.plan_types or [PlanType.MISSION]

    async def work(vehicle: Vehicle) -> int:
        return await _each(vehicle, chosen, "not cleared", lambda plan_type: _clear(vehicle, plan_type))

    return run_on_vehicle(arguments, work)


@on_vehicle
async def start(vehicle: Vehicle, arguments: Namespace) -> int:
    """Run `mav mission start`."""
    if arguments.wait:
        await _require_mission(vehicle)
        with notice_of_interruption(vehicle, "mission", _prefix(arguments)):
            await vehicle.mission.fly()
        echo(of_vehicle(vehicle, "mission: complete"))
    else:
        await start_mission(vehicle)
        echo(of_vehicle(vehicle, "mission: started"))
    return 0


def _prefix(arguments: Namespace) -> str:
    """Return the words before a command that stops the vehicle; in a session there are none."""
    return "" if hasattr(arguments, "session_work") else "mav vehicle "


async def start_mission(vehicle: Vehicle) -> None:
    """Arm the vehicle if needed, and start its mission."""
    await _require_mission(vehicle)
    await vehicle.mission.start(arm=True)


async def _require_mission(vehicle: Vehicle) -> None:
    """Raise if the vehicle reports that it has no mission, so that it is not armed for nothing."""
    try:
        current = await vehicle.component.request_message(
            common.MissionCurrent, timeout=OPTIONAL_MESSAGE_TIMEOUT
        )
    except RemoteError:
        return
    if current.mission_state == common.MissionState.NO_MISSION or current.total == NO_MISSION:
        raise CommandError(
            f"vehicle {vehicle.system} has no mission; upload one with `mav mission upload FILE`"
        )


async def download_plans(vehicle: Vehicle, plan_types: Sequence[PlanType], *, strict: bool) -> PlanFile:
    """Download plans; unless `strict`, a plan type that the vehicle does not support is empty."""
    plans = [await _download(vehicle, plan_type, strict=strict) for plan_type in plan_types]
    info = vehicle.component.info
    settings = Settings() if info is None else Settings(int(info.autopilot), int(info.type))
    plan = PlanFile.of_vehicle(plans, home_first=vehicle.component.mission.home_first, settings=settings)
    if plan.home is not None or PlanType.MISSION not in plan_types:
        return plan
    return PlanFile(plan.mission, plan.fence, plan.rally, await _home(vehicle), plan.settings)


async def _each(
    vehicle: Vehicle,
    chosen: Collection[PlanType],
    skipped: str,
    act: Callable[[PlanType], Coroutine[Any, Any, None]],
) -> int:
    """Act on each plan in the order of `ORDER`; after a failure report the remaining plans as skipped."""
    remaining = [plan_type for plan_type in ORDER if plan_type in chosen]
    try:
        while remaining:
            await act(remaining[0])
            del remaining[0]
    except MavstackError:
        for plan_type in remaining[1:]:
            echo(of_vehicle(vehicle, f"{PLAN_NAMES[plan_type]}: {skipped}"))
        raise
    return 0


async def _clear(vehicle: Vehicle, plan_type: PlanType) -> None:
    await _plans(vehicle, plan_type).clear()
    echo(of_vehicle(vehicle, f"{PLAN_NAMES[plan_type]}: cleared"))


async def _upload(vehicle: Vehicle, plan: PlanFile, plan_type: PlanType, *, verify: bool) -> None:
    wanted = plan.for_vehicle(plan_type, home_first=vehicle.component.mission.home_first)
    with TransferProgress(f"uploading the {PLAN_NAMES[plan_type]}", in_bytes=False) as progress:
        await _plans(vehicle, plan_type).upload(wanted, progress=progress)
    outcome = of_vehicle(vehicle, f"{PLAN_NAMES[plan_type]}: {_count(plan, plan_type)} uploaded")
    if verify:
        try:
            _compare(vehicle, plan_type, wanted, await _download(vehicle, plan_type, strict=True))
        except MavstackError:
            echo(outcome)
            raise
        outcome += " and verified"
    echo(outcome)


async def _download(vehicle: Vehicle, plan_type: PlanType, *, strict: bool) -> Plan:
    with TransferProgress(f"downloading the {PLAN_NAMES[plan_type]}", in_bytes=False) as progress:
        try:
            return await _plans(vehicle, plan_type).download(progress=progress)
        except ActionUnsupported:
            if strict or plan_type == PlanType.MISSION:
                raise
            return Plan(plan_type)
        except MissionDenied as error:
            if strict or plan_type == PlanType.MISSION or not _is_unsupported(error):
                raise
            return Plan(plan_type)


async def _home(vehicle: Vehicle) -> Home | None:
    try:
        home = await vehicle.component.request_message(common.HomePosition, timeout=OPTIONAL_MESSAGE_TIMEOUT)
    except RemoteError:
        return None
    return Home(home.latitude / 1e7, home.longitude / 1e7, home.altitude / 1e3)


def _plans(vehicle: Vehicle, plan_type: PlanType) -> VehiclePlan:
    return {PlanType.FENCE: vehicle.fence, PlanType.RALLY: vehicle.rally}.get(plan_type, vehicle.mission)


def _count(plan: PlanFile, plan_type: PlanType) -> str:
    count = len(plan.plan(plan_type))
    return f"{count} item{'' if count == 1 else 's'}"


def _plan_types_of_format(name: str | None) -> tuple[PlanType, ...]:
    """Return the plans that a file format can hold."""
    if name in ("plan", "json"):
        return (PlanType.MISSION, PlanType.FENCE, PlanType.RALLY)
    return {"fence": (PlanType.FENCE,), "rally": (PlanType.RALLY,)}.get(name or "", (PlanType.MISSION,))


def _compare(vehicle: Vehicle, plan_type: PlanType, uploaded: Plan, stored: Plan) -> None:
    """Raise if the stored plan differs from the uploaded one; the home of the vehicle is not compared."""
    skip = 1 if plan_type == PlanType.MISSION and vehicle.component.mission.home_first else 0
    operation = f"verifying the {PLAN_NAMES[plan_type]} of"
    if len(uploaded) != len(stored):
        answer = f"it has {len(stored)} items, {len(uploaded)} were uploaded"
        raise RemoteProtocolError(operation, str(vehicle.address), answer=answer)
    for seq, (ours, theirs) in enumerate(zip(uploaded.items, stored.items, strict=True)):
        difference = "" if seq < skip else _difference(ours, theirs)
        if difference:
            answer = f"item {seq} ({ours.name}) differs: {difference}"
            raise RemoteProtocolError(operation, str(vehicle.address), answer=answer)


def _difference(ours: MissionItem, theirs: MissionItem) -> str:
    """Return the difference of two items beyond the tolerances; NaN matches any value."""
    if ours.command != theirs.command:
        return f"it is {theirs.name}"
    steps = (0.0, 0.0, 0.0, 0.0, PLACE_STEP, PLACE_STEP, ALTITUDE_STEP)
    pairs = zip(params_of(ours), params_of(theirs), steps, strict=True)
    for number, (mine, its, step) in enumerate(pairs, 1):
        if not isnan(mine) and not abs(mine - its) <= step + RELATIVE_STEP * (abs(mine) if not step else 0):
            return f"param {number} is {its:g} instead of {mine:g}"
    return ""
