"""File trees that a vehicle serves over MAVLink FTP."""

from __future__ import annotations

import re
import struct
from errno import EINVAL

import pytest

from mavstack.dialects import common
from mavstack.services.ftp import DirectoryStore, FtpClient, FtpServer, MemoryStore
from mavstack.services.mission import MissionItem, Plan, PlanType, pack_plan, unpack_plan
from mavstack.services.parameters import ParameterDefinition, ParameterTable, packed, unpack, write_upload
from mavstack.sim.storage import ardupilot_root, file_store, px4_root
from tests.services.network import GROUND, VEHICLE, Network

PLAN = Plan.of(
    [MissionItem(common.MavCmd.NAV_TAKEOFF, param7=10.0), MissionItem(16, param5=47.1, param6=8.5)]
)


class Vehicle:
    """The callbacks of a file tree, with recorded writes."""

    def __init__(self, store=None) -> None:
        self.table = ParameterTable()
        for number in range(300):
            self.table.add(ParameterDefinition(f"NAME_{number:03}", float(number), default=float(number)))
        self.table.add(ParameterDefinition("WHOLE", 7, default=5))
        self.table.add(ParameterDefinition("MINUS", -2, default=5))
        self.plans = {PlanType.MISSION: PLAN}
        self.set: list = []
        self.now = 0.0
        self.store = store if store is not None else MemoryStore()
        self.ardupilot = ardupilot_root(
            self.store,
            self.table,
            self.plan,
            lambda: self.now,
            set_parameters=self.set.extend,
            set_plan=self.put,
        )

    def plan(self, kind: int) -> Plan:
        return self.plans.get(kind, Plan(kind))  # type: ignore[call-overload]

    def put(self, plan: Plan) -> None:
        if len(plan) > 5:
            raise OSError(EINVAL, "too long")
        self.plans[plan.type] = plan  # type: ignore[index]


def read(store, path: str) -> bytes:
    file = store.open_file(path)
    data = file.read(0, file.size())
    file.close()
    return data


def put(store, path: str, content: bytes) -> None:
    file = store.open_file(path, write=True, truncate=True)
    file.write(0, content)
    file.close()


def names(store, path: str) -> list[str]:
    return [entry.name for entry in store.list_directory(path)]


@pytest.fixture
def vehicle() -> Vehicle:
    return Vehicle()


def test_ardupilot_files(vehicle) -> None:
    root = vehicle.ardupilot
    assert names(root, "/") == ["@MISSION", "@PARAM", "@SYS", "APM"]
    assert names(root, "/APM") == ["LOGS", "TERRAIN", "scripts"]
    assert names(root, "@MISSION") == ["fence.dat", "mission.dat", "rally.dat"]
    assert names(root, "@PARAM") == ["param.pck"]
    assert {"uarts.txt", "tasks.txt", "threads.txt", "memory.txt"} <= set(names(root, "@SYS"))
    put(root, "/APM/scripts/hello.lua", b"return 1")
    assert read(root, "APM/scripts/hello.lua") == b"return 1"
    with pytest.raises(PermissionError):
        put(root, "@SYS/uarts.txt", b"x")


@pytest.mark.parametrize("name", ["uarts.txt", "tasks.txt", "threads.txt", "memory.txt", "timers.txt"])
def test_system_files_depend_on_the_uptime(vehicle, name) -> None:
    before = read(vehicle.ardupilot, "@SYS/" + name)
    assert before == read(vehicle.ardupilot, "@SYS/" + name)
    vehicle.now = 1e9
    after = read(vehicle.ardupilot, "@SYS/" + name).decode("ascii")
    assert re.match(r"\w+V\d\n", after)
    assert after.endswith("\n")
    assert max(map(len, after.splitlines())) < 120
    if name in ("uarts.txt", "timers.txt"):
        assert after.encode() != before


def test_packed_parameters(vehicle) -> None:
    found = unpack(read(vehicle.ardupilot, "@PARAM/param.pck"))
    assert found.complete
    assert found.parameters == tuple(vehicle.table.parameters())
    assert not found.with_defaults


@pytest.mark.parametrize(
    ("query", "start", "count"),
    [
        ("start=10&count=5", 10, 5),
        ("count=5", 0, 5),
        ("start=300", 300, 2),
        ("start=", 0, 302),
        ("count=0", 0, 302),
        ("count=5000", 0, 302),
        ("nonsense&start=301&more=1", 301, 1),
        ("", 0, 302),
    ],
)
def test_packed_parameters_with_a_query(vehicle, query, start, count) -> None:
    found = unpack(read(vehicle.ardupilot, "@PARAM/param.pck?" + query), start=start)
    assert found.parameters == tuple(vehicle.table.parameters()[start : start + count])
    assert found.total == 302


def test_packed_parameters_with_defaults(vehicle) -> None:
    found = unpack(read(vehicle.ardupilot, "@PARAM/param.pck?withdefaults=1&start=299"), start=299)
    assert found.with_defaults
    assert found.defaults == {"NAME_299": 299.0, "WHOLE": 5, "MINUS": 5}


@pytest.mark.parametrize(
    "query", ["start=302", "start=65535", "count=65535", "withdefaults=2", "count=999999999"]
)
def test_invalid_query_is_refused(vehicle, query) -> None:
    with pytest.raises(OSError, match="no such") as refused:
        vehicle.ardupilot.open_file("@PARAM/param.pck?" + query)
    assert refused.value.errno == EINVAL


def test_parameter_upload(vehicle) -> None:
    parameters = vehicle.table.parameters()[:3]
    put(vehicle.ardupilot, "@PARAM/param.pck", write_upload(parameters))
    assert [(parameter.name, parameter.value) for parameter in vehicle.set] == [
        (parameter.name, parameter.value) for parameter in parameters
    ]
    for content in (b"", b"x" * 40, packed.write(parameters)[:-1]):
        with pytest.raises(OSError, match="no parameters"):
            put(vehicle.ardupilot, "@PARAM/param.pck", content)
    assert len(vehicle.set) == 3


def test_plan_download_and_upload(vehicle) -> None:
    root = vehicle.ardupilot
    assert unpack_plan(read(root, "@MISSION/mission.dat")).plan == PLAN
    assert len(unpack_plan(read(root, "@MISSION/rally.dat")).plan) == 0
    fence = Plan.of(
        [MissionItem(common.MavCmd.NAV_FENCE_CIRCLE_INCLUSION, 50, param5=47.0, param6=8.0)], PlanType.FENCE
    )
    put(root, "@MISSION/fence.dat", pack_plan(fence))
    assert vehicle.plans[PlanType.FENCE] == fence
    part = bytearray(pack_plan(Plan.of(PLAN.items[:1])))
    struct.pack_into("<HH", part, 4, 1, 2)
    put(root, "@MISSION/mission.dat", bytes(part))
    assert len(vehicle.plans[PlanType.MISSION]) == 3
    for content in (b"", pack_plan(fence), pack_plan(Plan.of(PLAN.items * 4)), pack_plan(PLAN)[:-1]):
        with pytest.raises(OSError, match=r"plan|long"):
            put(root, "@MISSION/mission.dat", content)
    assert len(vehicle.plans[PlanType.MISSION]) == 3


def test_files_without_a_setter_are_read_only() -> None:
    vehicle = Vehicle()
    root = ardupilot_root(MemoryStore(), vehicle.table, vehicle.plan, lambda: 0.0)
    for path in ("@MISSION/mission.dat", "@PARAM/param.pck"):
        with pytest.raises(PermissionError):
            put(root, path, b"x")


def bson(data: bytes) -> dict[str, float]:
    """Parse the element types that PX4 writes."""
    (size,) = struct.unpack_from("<i", data)
    assert size == len(data)
    assert data[-1] == 0
    found, at = {}, 4
    while at < size - 1:
        kind, end = data[at], data.index(0, at + 1)
        code = {0x10: "<i", 0x01: "<d"}[kind]
        (found[data[at + 1 : end].decode()],) = struct.unpack_from(code, data, end + 1)
        at = end + 1 + struct.calcsize(code)
    return found


def test_px4_files(vehicle) -> None:
    root = px4_root(MemoryStore(), vehicle.table)
    assert names(root, "/") == ["etc", "fs"]
    assert names(root, "/fs/microsd") == ["etc", "log", "params"]
    assert read(root, "/etc/init.d/rcS").startswith(b"#")
    assert bson(read(root, "/fs/microsd/params")) == {"WHOLE": 7, "MINUS": -2}
    vehicle.table["NAME_003"].value = 3.25
    assert bson(read(root, "/fs/microsd/params"))["NAME_003"] == 3.25
    put(root, "/fs/microsd/etc/extras.txt", b"x")
    with pytest.raises(PermissionError):
        put(root, "/etc/init.d/rcS", b"x")
    with pytest.raises(PermissionError):
        put(root, "/etc/new", b"x")


def test_folder_keeps_files(tmp_path) -> None:
    folder = tmp_path / "deep" / "vehicle 1"
    store = file_store(folder)
    assert isinstance(store, DirectoryStore)
    vehicle = Vehicle(store)
    put(vehicle.ardupilot, "/APM/scripts/a.lua", b"1")
    assert (folder / "APM" / "scripts" / "a.lua").read_bytes() == b"1"
    again = Vehicle(file_store(folder))
    assert read(again.ardupilot, "/APM/scripts/a.lua") == b"1"


def test_memory_store_has_a_capacity() -> None:
    store = file_store()
    for number in range(32):
        put(store, f"{number}", bytes(1 << 20))
    with pytest.raises(OSError, match="full"):
        put(store, "one more", b"x")


def test_over_the_network(vehicle) -> None:
    network = Network(3)
    far = network.node(VEHICLE)
    far.engine.add(FtpServer(VEHICLE, vehicle.ardupilot))
    ground = network.node(GROUND)
    client = ground.engine.add(FtpClient(GROUND, VEHICLE))
    network.connect(ground, far)

    def run(operation):
        ground.engine.touch(client)
        assert network.run(lambda: operation.done, timeout=600)
        return operation.result()

    assert unpack(run(client.download("@PARAM/param.pck?withdefaults=1", network.now))).complete
    run(client.upload("@MISSION/rally.dat", pack_plan(Plan.of(PLAN.items[1:], PlanType.RALLY)), network.now))
    assert len(vehicle.plans[PlanType.RALLY]) == 1
    listed = run(client.list_directory("/", network.now))
    assert [entry.name for entry in listed] == ["@MISSION", "@PARAM", "@SYS", "APM"]
    for path in ("@SYS/uarts.txt", "@MISSION/mission.dat"):
        assert run(client.download(path, network.now)) == read(vehicle.ardupilot, path)
