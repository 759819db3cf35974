"""Typical programs on the blocking API; read by type checkers, and not run."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, assert_type

import mavstack.sync
from mavstack.dialects import common
from mavstack.errors import CommandDenied, RemoteTimeout
from mavstack.services.mission import MissionItem, Plan
from mavstack.services.parameters import Parameter
from mavstack.sync import Connection, Group, Node, Params, RemoteComponent, Subscription, Vehicle
from mavstack.vehicle import VehicleFound

if TYPE_CHECKING:
    from mavstack.services.command import CommandRequest


def print_progress(done: int, total: int) -> None:
    print(f"{done} of {total}")


def fly_a_square(url: str) -> None:
    with mavstack.sync.connect(url) as connection:
        assert_type(connection, Connection)
        vehicle = connection.wait_for_vehicle()
        assert_type(vehicle, Vehicle)
        vehicle.wait_until_ready(timeout=None)
        vehicle.arm(timeout=10)
        vehicle.takeoff(10)
        for north, east in ((20.0, 0.0), (0.0, 20.0)):
            vehicle.move(north, east)
        if vehicle.position is not None:
            print(vehicle.position.latitude, vehicle.battery)
        vehicle.rtl()


def read_messages(vehicle: Vehicle) -> float:
    with vehicle.stream(common.Attitude, rate=10) as attitudes:
        for attitude in attitudes:
            assert_type(attitude, common.Attitude)
            if attitude.roll > 1:
                return attitude.roll
    latest = vehicle.latest(common.VfrHud)
    return latest.airspeed if latest is not None else 0.0


def transfer(vehicle: Vehicle) -> None:
    params: Params = vehicle.params
    assert_type(params.download(progress=print_progress), Mapping[str, Parameter])
    assert_type(params.set("RTL_ALT", 30), Parameter)
    assert_type(vehicle.ftp.download("/log.bin", timeout=30), bytes)
    vehicle.mission.upload([MissionItem(common.MavCmd.NAV_TAKEOFF, param7=10.0)])
    assert_type(vehicle.mission.download(), Plan)
    for entry in vehicle.logs.list():
        vehicle.logs.download(entry)


def use_a_dialect_of_ones_own(path: str) -> RemoteComponent:
    connection = mavstack.sync.connect("udpin://127.0.0.1:0", dialect=mavstack.Dialect.from_xml(path))
    vehicle = connection.wait_for_vehicle()
    assert_type(vehicle.component, RemoteComponent)
    return vehicle.component


def follow_setpoints(vehicle: Vehicle) -> None:
    with vehicle.guided() as session:
        session.velocity(1.0, 0.0, 0.5)
        session.position(10.0, 0.0, 20.0, yaw=90.0)


def read_one(vehicle: Vehicle) -> Parameter:
    return vehicle.params.get("SYSID_THISMAV")


def command_a_fleet(connection: Connection) -> None:
    group: Group = connection.group()
    for vehicle, parameter in group.each(read_one, max_concurrency=4).check().items():
        assert_type(vehicle, Vehicle)
        assert_type(parameter, Parameter)
    group.each(lambda vehicle: vehicle.arm()).check()
    with connection.events(VehicleFound) as events:
        assert_type(events, Subscription[VehicleFound])
        print(next(events))


def ask(node: Node) -> None:
    component = node.wait_for_autopilot(1)
    assert_type(component, RemoteComponent)
    try:
        result = component.command(common.MavCmd.DO_SET_SERVO, 5, 1500, timeout=3)
        print(result.attempts)
    except CommandDenied as error:
        print(error.code, error.operation, error.status_texts)
    except RemoteTimeout as error:
        print(error.attempts)
    assert_type(component.request_message(common.HomePosition), common.HomePosition)
    component.set_message_rate(common.Attitude, 50)
    node.add_listener(common.Attitude, lambda message: print(message.yaw)).close()


def offer_a_camera() -> None:
    with Node("udpout://127.0.0.1:14550", system=1, component=100, type=common.MavType.CAMERA) as node:

        @node.on_command(common.MavCmd.IMAGE_START_CAPTURE)
        def capture(request: CommandRequest) -> common.MavResult:
            return common.MavResult.ACCEPTED

        node.send_statustext("ready")
        node.serve_forever()
