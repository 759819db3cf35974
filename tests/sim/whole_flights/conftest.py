"""Flights that the tests of this folder share, also between the processes of one test run."""

from __future__ import annotations

import pickle
import time
from typing import TYPE_CHECKING

import pytest

from mavstack.sim.vehicle_types import Firmware, VehicleType
from tests.sim.whole_flights.fleet import fly_all
from tests.sim.whole_flights.plans import triangle, whole_mission

if TYPE_CHECKING:
    from collections.abc import Callable

    from tests.sim.whole_flights.ground_station import Flight

    Flights = dict[tuple[VehicleType, Firmware], Flight]

COPTERS = [(VehicleType.COPTER, firmware) for firmware in Firmware]
#: Every type once, with the firmwares in turn.
WINDY_FLIGHTS = [(kind, list(Firmware)[number % 2]) for number, kind in enumerate(VehicleType)]


def fly_once(factory: pytest.TempPathFactory, worker: str, name: str, fly: Callable[[], Flights]) -> Flights:
    """Fly in the first process of the test run; the other processes wait for its result."""
    if worker == "master":
        return fly()
    folder = factory.getbasetemp().parent
    lock, result, failed = folder / f"{name}.mine", folder / f"{name}.pickle", folder / f"{name}.failed"
    try:
        lock.touch(exist_ok=False)
    except FileExistsError:
        while not result.exists():
            if failed.exists():
                pytest.fail(failed.read_text())
            time.sleep(0.1)
        return pickle.loads(result.read_bytes())
    try:
        flights = fly()
    except BaseException as error:
        failed.write_text(f"in another process: {error!r}")
        raise
    written = folder / f"{name}.part"
    written.write_bytes(pickle.dumps(flights))
    written.rename(result)
    return flights


@pytest.fixture(scope="session")
def worker(request: pytest.FixtureRequest) -> str:
    """The id of the process in a test run; "master" if there is only one."""
    return getattr(request.config, "workerinput", {}).get("workerid", "master")


@pytest.fixture(scope="session")
def still_air(tmp_path_factory: pytest.TempPathFactory, worker: str) -> Flights:
    """Fly the whole mission with every type and firmware, in still air."""
    return fly_once(tmp_path_factory, worker, "still_air", lambda: fly_all(whole_mission, logs=COPTERS))


@pytest.fixture(scope="session")
def windy(tmp_path_factory: pytest.TempPathFactory, worker: str) -> Flights:
    """Fly a triangle with every type, in 6 m/s of wind with gusts, with a coarser step."""
    return fly_once(
        tmp_path_factory, worker, "windy", lambda: fly_all(triangle, WINDY_FLIGHTS, wind=6, rate=25)
    )


@pytest.fixture(scope="session")
def far_away(tmp_path_factory: pytest.TempPathFactory, worker: str) -> Flights:
    """Fly copters over a radio with loss and latency."""
    impairment = {"loss": 0.1, "latency": 0.2, "jitter": 0.05, "seed": 3}
    return fly_once(tmp_path_factory, worker, "far_away", lambda: fly_all(triangle, COPTERS, **impairment))
