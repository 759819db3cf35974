"""The storage of a vehicle: files and logs of its firmware."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from mavstack.dialects import common
from mavstack.services import Address
from mavstack.services.mission import MissionItem, MissionServer, Plan, PlanType, pack_plan, unpack_plan
from mavstack.services.parameters import Parameter, unpack, write_upload
from mavstack.sim.parameters import Parameters
from mavstack.sim.storage import DataflashLogs, Storage, UlogLogs
from mavstack.sim.vehicle_types import DEFAULT_HOME, Firmware, VehicleType
from tests.sim.storage.samples import BOOT, read_dataflash, read_ulog, sample
from tests.sim.storage.test_roots import names, put, read

ACCEPTED, DENIED = common.MavMissionResult.ACCEPTED, common.MavMissionResult.DENIED
PLAN = Plan.of([MissionItem(16, param5=47.0, param6=8.0), MissionItem(common.MavCmd.NAV_LAND)])


def make_vehicle(firmware: Firmware, vehicle_type: VehicleType = VehicleType.COPTER) -> SimpleNamespace:
    address = Address(9, 1)
    return SimpleNamespace(
        firmware=firmware,
        vehicle_type=vehicle_type,
        address=address,
        parameters=Parameters(firmware, vehicle_type, 9),
        mission=MissionServer(address, validate=lambda plan, source: ACCEPTED if len(plan) < 9 else DENIED),
        touched=[],
        touch=lambda service: None,
        uptime=12.5,
        booted_at=BOOT,
        autopilot=SimpleNamespace(home=DEFAULT_HOME, mode=SimpleNamespace(number=4)),
        body=SimpleNamespace(frame=SimpleNamespace(to_global=lambda *position: (47.0, 8.0, 488.0))),
    )


@pytest.fixture
def ardupilot() -> SimpleNamespace:
    return make_vehicle(Firmware.ARDUPILOT)


def test_dataflash_log_has_the_facts_of_the_vehicle(ardupilot, tmp_path) -> None:
    storage = Storage(ardupilot)
    assert isinstance(storage.logs, DataflashLogs)
    ardupilot.mission.replace(PLAN)
    storage.logs.begin(1_000_000)
    storage.logs.write(sample(1_000_000))
    storage.logs.end()
    path = "/APM/LOGS/00000001.BIN"
    found = read_dataflash(read(storage.files, path), tmp_path)
    assert found["MSG"][0]["Message"] == storage.firmware
    assert len(found["PARM"]) == len(ardupilot.parameters)
    assert {message["Name"] for message in found["PARM"]} == {
        each.name for each in ardupilot.parameters.table
    }
    assert len(found["CMD"]) == 2
    assert found["MODE"][0]["ModeNum"] == 4
    assert found["ORGN"][-1]["Lat"] == pytest.approx(DEFAULT_HOME.latitude)


def test_px4_log_has_the_parameters(tmp_path) -> None:
    vehicle = make_vehicle(Firmware.PX4)
    storage = Storage(vehicle, folder=tmp_path)
    assert isinstance(storage.logs, UlogLogs)
    storage.logs.begin(0)
    storage.logs.write(sample(0))
    storage.logs.end()
    (day,) = (tmp_path / "fs" / "microsd" / "log").iterdir()
    (file,) = day.iterdir()
    log = read_ulog(file.read_bytes())
    assert len(log.initial_parameters) == len(vehicle.parameters)
    assert log.initial_parameters["MAV_SYS_ID"] == 9
    assert names(storage.files, "/fs/microsd/log") == [day.name]


@pytest.mark.parametrize("firmware", list(Firmware))
@pytest.mark.parametrize("vehicle_type", list(VehicleType))
def test_firmware_banner(firmware, vehicle_type) -> None:
    assert Storage(make_vehicle(firmware, vehicle_type)).firmware.startswith(("Ardu", "PX4"))


def test_uploaded_plans_are_validated(ardupilot) -> None:
    files = Storage(ardupilot).files
    put(files, "@MISSION/mission.dat", pack_plan(PLAN))
    assert ardupilot.mission.plan(PlanType.MISSION) == PLAN
    assert unpack_plan(read(files, "@MISSION/mission.dat")).plan == PLAN
    with pytest.raises(OSError, match="refused"):
        put(files, "@MISSION/mission.dat", pack_plan(Plan.of(PLAN.items * 5)))
    assert ardupilot.mission.plan(PlanType.MISSION) == PLAN


def test_uploaded_parameters_are_set_all_or_none(ardupilot) -> None:
    files, table = Storage(ardupilot).files, ardupilot.parameters.table
    one, other = table["RTL_ALT"], table["WPNAV_SPEED"]
    before = one.value
    uploaded = [
        Parameter(each.name, each.value + 1, each.kind, table.index_of(each.name)) for each in (one, other)
    ]
    other.maximum = other.value
    with pytest.raises(OSError, match="refused"):
        put(files, "@PARAM/param.pck", write_upload(uploaded))
    assert one.value == before
    other.maximum = None
    one.maximum = None
    put(files, "@PARAM/param.pck", write_upload([*uploaded, Parameter("NOT_OURS", 1.0, 9, 0)]))
    assert one.value == before + 1
    assert unpack(read(files, "@PARAM/param.pck")).complete
