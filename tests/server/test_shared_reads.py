"""Reads of vehicles: shared by those who ask at once, fresh for observers, and behind a pilot's writes."""

from __future__ import annotations

import asyncio
import json

import pytest

from mavstack.errors import RemoteTimeout
from mavstack.files.plans import PlanFile, format_plan
from mavstack.http.bodies import RefusedError
from mavstack.security.roles import Role
from mavstack.server.access import Access
from mavstack.server.shared_reads import FRESH, MAX_BURST, MAX_RESULTS, Key, SharedReads
from mavstack.services.mission import MissionItem
from mavstack.services.mission.stale_messages import SETTLE
from mavstack.sim.vehicle_types import DEFAULT_HOME as HOME
from mavstack.vehicle.mission import VehiclePlan
from tests.server.stations import COPTER, Ground, serve

PLAN, OTHER = Key(1, "mission"), Key(2, "mission")
PASSWORDS = {Role.OBSERVE: "watching only", Role.OPERATE: "may fly it"}


class Vehicle:
    """A vehicle whose reads end when the test says so."""

    def __init__(self) -> None:
        self.now = 1000.0
        self.reads = SharedReads(lambda: self.now)
        self.begun: list[asyncio.Future[str]] = []

    def ask(self, key: Key = PLAN, *, observes: bool = False) -> asyncio.Task[str]:
        async def work() -> str:
            self.begun.append(asyncio.get_running_loop().create_future())
            return await self.begun[-1]

        return asyncio.create_task(self.reads.read(key, work, observes=observes))


@pytest.fixture
def vehicle() -> Vehicle:
    return Vehicle()


async def settle() -> None:
    for _ in range(10):
        await asyncio.sleep(0)


async def test_those_who_ask_at_the_same_time_share_one_read(vehicle):
    asked = [vehicle.ask(observes=number % 2 == 0) for number in range(10)]
    await settle()
    (read,) = vehicle.begun
    read.set_result("a plan")
    assert await asyncio.gather(*asked) == ["a plan"] * 10


async def test_observers_get_a_fresh_result_and_pilots_read_again(vehicle):
    first = vehicle.ask()
    await settle()
    vehicle.begun[0].set_result("old")
    await first
    assert await vehicle.ask(observes=True) == "old"
    pilot = vehicle.ask()
    await settle()
    vehicle.begun[1].set_result("new")
    assert await pilot == "new"
    vehicle.now += FRESH
    again = vehicle.ask(observes=True)
    await settle()
    assert len(vehicle.begun) == 3
    again.cancel()


async def test_a_write_ends_the_reads_of_its_vehicle_which_begin_again_after_it(vehicle):
    reading, other = vehicle.ask(), vehicle.ask(OTHER)
    await settle()
    with vehicle.reads.writing(1):
        await settle()
        assert [read.cancelled() for read in vehicle.begun] == [True, False]
        late = vehicle.ask(observes=True)
        await settle()
        assert len(vehicle.begun) == 2
    await settle()
    assert len(vehicle.begun) == 3
    vehicle.begun[2].set_result("a new plan")
    assert await asyncio.gather(reading, late) == ["a new plan"] * 2
    other.cancel()


async def test_a_write_makes_known_results_old(vehicle):
    first = vehicle.ask()
    await settle()
    vehicle.begun[0].set_result("old")
    await first
    with vehicle.reads.writing(1):
        pass
    again = vehicle.ask(observes=True)
    await settle()
    assert len(vehicle.begun) == 2
    again.cancel()


async def test_a_read_for_which_no_client_waits_ends(vehicle):
    asked = [vehicle.ask(), vehicle.ask()]
    await settle()
    asked[0].cancel()
    await settle()
    assert not vehicle.begun[0].cancelled()
    asked[1].cancel()
    await settle()
    assert vehicle.begun[0].cancelled()


async def test_an_error_of_a_read_is_that_of_all_and_is_not_kept(vehicle):
    asked = [vehicle.ask(), vehicle.ask()]
    await settle()
    vehicle.begun[0].set_exception(RemoteTimeout("reading", "1/1", attempts=1))
    answers = await asyncio.gather(*asked, return_exceptions=True)
    assert [type(each) for each in answers] == [RemoteTimeout] * 2
    again = vehicle.ask(observes=True)
    await settle()
    assert len(vehicle.begun) == 2
    again.cancel()


async def test_observers_begin_few_reads_per_second(vehicle):
    asked = [vehicle.ask(Key(1, f"parameter {number}"), observes=True) for number in range(100)]
    await settle()
    assert len(vehicle.begun) == MAX_BURST
    refused = [each for each in asked if each.done()]
    assert {type(each.exception()) for each in refused} == {RefusedError}
    pilot = vehicle.ask()
    await settle()
    assert len(vehicle.begun) == MAX_BURST + 1
    for task in (*asked, pilot):
        task.cancel()


async def test_results_are_bounded_and_hold_no_files(vehicle):
    async def file() -> bytes:
        return b"a log"

    async def value() -> int:
        return 1

    await vehicle.reads.read(Key(1, "log 1"), file)
    assert not vehicle.reads._results
    for number in range(2 * MAX_RESULTS):
        await vehicle.reads.read(Key(1, str(number)), value)
    assert len(vehicle.reads._results) == MAX_RESULTS


def test_ten_observers_that_read_plans_do_not_delay_an_upload(monkeypatch):
    """Before: an upload of 0.16 s took 18 s. A download that ends for it needs a moment to be over."""
    downloads, download = [], VehiclePlan.download

    async def counted(self, **options):
        downloads.append(self)
        return await download(self, **options)

    monkeypatch.setattr(VehiclePlan, "download", counted)
    places = [(HOME.latitude + number * 1e-4, HOME.longitude) for number in range(40)]
    plan = format_plan(PlanFile.of([MissionItem.waypoint(*each, 20.0) for each in places]), "plan").text

    async def scenario(ground: Ground) -> None:
        now = ground.station.connection.now
        tokens = [
            (await ground.api.post("/api/session", {"password": password})).json["token"]
            for password in PASSWORDS.values()
        ]
        observer, pilot = ({"authorization": f"Bearer {token}"} for token in tokens)
        path = "/api/vehicles/1/mission"

        async def upload() -> float:
            began = now()
            assert (await ground.api.put(path, data=plan.encode(), headers=pilot)).status == 200
            return now() - began

        alone, stop = await upload(), asyncio.Event()
        statuses: set[int] = set()

        async def observe() -> None:
            while not stop.is_set():
                answer = await ground.api.get(path, headers=observer)
                statuses.add(answer.status)
                if answer.status == 200:
                    assert len(json.loads(answer.data)["mission"]) == 40
                await asyncio.sleep(0.01)

        observers = [asyncio.create_task(observe()) for _ in range(10)]
        await asyncio.sleep(1.0)
        downloads.clear()
        delays = [await upload() - alone for _ in range(5)]
        stop.set()
        await asyncio.gather(*observers)
        assert max(delays) <= SETTLE + 0.1
        assert len(downloads) <= MAX_BURST
        assert statuses <= {200, 429}

    serve(COPTER, scenario, access=Access(passwords=PASSWORDS, local=False))
