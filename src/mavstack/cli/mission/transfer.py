"""What `mav mission` does with a vehicle: give, get and clear plans, and have the mission flown.

Several plans are given one after the other, the mission last: it is not to be flown without the fence that
was made for it. What became of each is told, also when one was refused and the others were not sent.
"""

from __future__ import annotations

import sys
from math import isnan
from typing import TYPE_CHECKING, Any, Final

from mavstack.cli.common.errors import CommandError
from mavstack.cli.common.connection import run_on_vehicle
from mavstack.cli.common.transfer_progress import TransferProgress
from mavstack.cli.mission.files import STANDARD, chosen_of, judge, read, save
from mavstack.dialects import common
from mavstack.errors import MavstackError, MissionDenied, RemoteError, RemoteProtocolError
from mavstack.files.plans import Home, PlanFile, Settings, format_of
from mavstack.files.plans.model import KINDS, params_of
from mavstack.services.mission import Plan, PlanType
from mavstack.services.mission.server import NO_MISSION

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Callable, Collection, Coroutine, Sequence

    from mavstack.services.mission import MissionItem
    from mavstack.vehicle import Vehicle
    from mavstack.vehicle.mission import VehiclePlan

#: In this order plans are given and cleared.
ORDER: Final = (PlanType.FENCE, PlanType.RALLY, PlanType.MISSION)
#: How long to wait for a message that a vehicle is asked for but need not have, in seconds.
ASKING_PATIENCE: Final = 2.0
#: What vehicles keep of a place, in degrees, and of an altitude, in metres.
PLACE_STEP: Final = 2e-7
ALTITUDE_STEP: Final = 0.01
RELATIVE_STEP: Final = 1e-5


def upload(arguments: Namespace) -> int:
    """`mav mission upload`."""
    name, plan = read(arguments.file)
    chosen = chosen_of(plan, arguments.kinds, name)
    if not arguments.force:
        judge(plan.only(chosen), name)
    for note in plan.notes:
        print(f"mav mission: note: {note}", file=sys.stderr)

    async def work(vehicle: Vehicle) -> int:
        return await _each(
            chosen, "not sent", lambda kind: _give(vehicle, plan, kind, verify=arguments.verify)
        )

    return run_on_vehicle(arguments, work)


def download(arguments: Namespace) -> int:
    """`mav mission download`."""
    to_file = arguments.file != STANDARD
    name = arguments.format or (format_of(arguments.file) if to_file else None)
    kinds = tuple(dict.fromkeys(arguments.kinds or _held_by(name)))

    async def work(vehicle: Vehicle) -> int:
        plan = await fetch(vehicle, kinds, strict=bool(arguments.kinds) or len(kinds) == 1)
        save(plan, arguments.file, name, force=arguments.force)
        if to_file:
            counts = ", ".join(f"{KINDS[kind]}: {_count(plan, kind)}" for kind in kinds)
            print(f"{arguments.file}: {counts}")
        return 0

    return run_on_vehicle(arguments, work)


def clear(arguments: Namespace) -> int:
    """`mav mission clear`."""
    chosen = arguments.kinds or [PlanType.MISSION]

    async def work(vehicle: Vehicle) -> int:
        return await _each(chosen, "not cleared", lambda kind: _clear(vehicle, kind))

    return run_on_vehicle(arguments, work)


def start(arguments: Namespace) -> int:
    """`mav mission start`."""

    async def work(vehicle: Vehicle) -> int:
        if arguments.wait:
            await _expect_mission(vehicle)
            await vehicle.mission.fly()
            print("mission: flown")
        else:
            await start_mission(vehicle)
            print("mission: started")
        return 0

    return run_on_vehicle(arguments, work)


async def start_mission(vehicle: Vehicle) -> None:
    """Arm if need be, and have the mission flown."""
    await _expect_mission(vehicle)
    if not vehicle.armed:
        await vehicle.arm()
    await vehicle.mission.start()


async def _expect_mission(vehicle: Vehicle) -> None:
    """Raise if it says that it has no mission: it would be armed, and then have nothing to do."""
    try:
        told = await vehicle.component.request_message(common.MissionCurrent, timeout=ASKING_PATIENCE)
    except RemoteError:
        return
    if told.mission_state == common.MissionState.NO_MISSION or told.total == NO_MISSION:
        raise CommandError(f"system {vehicle.system} has no mission: `mav mission upload FILE` gives it one")


async def fetch(vehicle: Vehicle, kinds: Sequence[PlanType], *, strict: bool) -> PlanFile:
    """The plans of a vehicle; unless `strict`, those that it does not know at all are empty."""
    plans = [await _get(vehicle, kind, strict=strict) for kind in kinds]
    client = vehicle.component.mission_client
    info = vehicle.component.info
    settings = Settings() if info is None else Settings(int(info.autopilot), int(info.type))
    plan = PlanFile.of_vehicle(plans, home_first=client.home_first, settings=settings)
    if plan.home is not None or PlanType.MISSION not in kinds:
        return plan
    return PlanFile(plan.mission, plan.fence, plan.rally, await _home(vehicle), plan.settings)


async def _each(
    chosen: Collection[PlanType], otherwise: str, carry_out: Callable[[PlanType], Coroutine[Any, Any, None]]
) -> int:
    """Do something with each plan in their order; when one fails, say so of those that were yet to come."""
    waiting = [kind for kind in ORDER if kind in chosen]
    try:
        while waiting:
            await carry_out(waiting[0])
            del waiting[0]
    except MavstackError:
        for kind in waiting[1:]:
            print(f"{KINDS[kind]}: {otherwise}")
        raise
    return 0


async def _clear(vehicle: Vehicle, kind: PlanType) -> None:
    await _plans(vehicle, kind).clear()
    print(f"{KINDS[kind]}: cleared")


async def _give(vehicle: Vehicle, plan: PlanFile, kind: PlanType, *, verify: bool) -> None:
    given = plan.for_vehicle(kind, home_first=vehicle.component.mission_client.home_first)
    with TransferProgress(f"giving the {KINDS[kind]}", in_bytes=False) as progress:
        await _plans(vehicle, kind).upload(given, progress=progress)
    told = f"{KINDS[kind]}: {_count(plan, kind)} given"
    if verify:
        try:
            _compare(vehicle, kind, given, await _get(vehicle, kind, strict=True))
        except MavstackError:
            print(told)
            raise
        told += ", and read back the same"
    print(told)


async def _get(vehicle: Vehicle, kind: PlanType, *, strict: bool) -> Plan:
    with TransferProgress(f"getting the {KINDS[kind]}", in_bytes=False) as progress:
        try:
            return await _plans(vehicle, kind).download(progress=progress)
        except MissionDenied as error:
            unknown = error.code == common.MavMissionResult.UNSUPPORTED and kind != PlanType.MISSION
            if strict or not unknown:
                raise
            return Plan(kind)


async def _home(vehicle: Vehicle) -> Home | None:
    try:
        told = await vehicle.component.request_message(common.HomePosition, timeout=ASKING_PATIENCE)
    except RemoteError:
        return None
    return Home(told.latitude / 1e7, told.longitude / 1e7, told.altitude / 1e3)


def _plans(vehicle: Vehicle, kind: PlanType) -> VehiclePlan:
    return {PlanType.FENCE: vehicle.fence, PlanType.RALLY: vehicle.rally}.get(kind, vehicle.mission)


def _count(plan: PlanFile, kind: PlanType) -> str:
    count = len(plan.plan(kind))
    return f"{count} item{'' if count == 1 else 's'}"


def _held_by(name: str | None) -> tuple[PlanType, ...]:
    """Which plans a format holds."""
    if name in ("plan", "json"):
        return (PlanType.MISSION, PlanType.FENCE, PlanType.RALLY)
    return {"fence": (PlanType.FENCE,), "rally": (PlanType.RALLY,)}.get(name or "", (PlanType.MISSION,))


def _compare(vehicle: Vehicle, kind: PlanType, given: Plan, held: Plan) -> None:
    """Raise if a vehicle holds something else than it was given; its own home is no difference."""
    skip = 1 if kind == PlanType.MISSION and vehicle.component.mission_client.home_first else 0
    what = f"reading back the {KINDS[kind]}"
    if len(given) != len(held):
        answer = f"it holds {len(held)} items, not the {len(given)} that were given"
        raise RemoteProtocolError(what, str(vehicle.address), answer=answer)
    for seq, (ours, theirs) in enumerate(zip(given.items, held.items, strict=True)):
        difference = "" if seq < skip else _difference(ours, theirs)
        if difference:
            answer = f"it holds another item {seq} ({ours.name}): {difference}"
            raise RemoteProtocolError(what, str(vehicle.address), answer=answer)


def _difference(ours: MissionItem, theirs: MissionItem) -> str:
    """How an item differs; NaN leaves it to the vehicle, and small steps are how vehicles store numbers."""
    if ours.command != theirs.command:
        return f"{theirs.name}"
    steps = (0.0, 0.0, 0.0, 0.0, PLACE_STEP, PLACE_STEP, ALTITUDE_STEP)
    pairs = zip(params_of(ours), params_of(theirs), steps, strict=True)
    for number, (mine, its, step) in enumerate(pairs, 1):
        if not isnan(mine) and not abs(mine - its) <= step + RELATIVE_STEP * (abs(mine) if not step else 0):
            return f"param {number} is {its:g} instead of {mine:g}"
    return ""
