from __future__ import annotations

from mavstack.dialects import common
from mavstack.services import Address
from mavstack.services.remote_id import RemoteIdMonitor
from mavstack.services.remote_id.monitor import id_text
from tests.services.network import GROUND, START, VEHICLE
from tests.services.single_service import deliver, feed_random_messages

MODULE = Address(1, 236)
BEAT = common.Heartbeat(type=common.MavType.ODID, autopilot=common.MavAutopilot.INVALID)


def hear(monitor: RemoteIdMonitor, *messages, source: Address = MODULE, now: float = START) -> None:
    for message in messages:
        deliver(monitor, message, source, now)


def test_no_module():
    monitor = RemoteIdMonitor(GROUND, 1)
    assert monitor.status(START).reasons == ("no Remote ID module was heard",)
    hear(monitor, BEAT, source=Address(2, 236))  # of another vehicle
    hear(monitor, BEAT, source=VEHICLE)
    assert monitor.status(START).module is None
    hear(monitor, BEAT)
    silent = monitor.status(START)
    assert (silent.module, silent.may_arm) == (236, None)
    assert silent.reasons == ("the module sends no OPEN_DRONE_ID_ARM_STATUS",)
    assert monitor.status(START + 4).reasons == ("the Remote ID module 236 is silent",)


def test_reasons_and_readiness():
    monitor = RemoteIdMonitor(GROUND, 1)
    hear(monitor, BEAT, common.OpenDroneIdArmStatus(status=1, error="missing operator location"))
    status = monitor.status(START)
    assert status.may_arm is False
    assert status.reasons[0] == "missing operator location"
    assert any("mav rid send" in reason for reason in status.reasons)
    hear(
        monitor,
        common.OpenDroneIdArmStatus(status=0),
        common.OpenDroneIdBasicId(uas_id=b"1596F3".ljust(20, b"\0")),
    )
    hear(
        monitor,
        common.OpenDroneIdSystemUpdate(operator_latitude=470000000, operator_longitude=80000000),
        source=GROUND,
    )
    hear(monitor, common.OpenDroneIdLocation(status=2, latitude=1, longitude=2), source=VEHICLE)
    status = monitor.status(START)
    assert (status.may_arm, status.reasons, status.uas_id) == (True, (), "1596F3")
    assert (status.operator, status.location, status.status) == ((47.0, 8.0), (1e-7, 2e-7), 2)
    assert monitor.status(START + 6).operator is None


def test_ids_that_are_no_text():
    assert id_text(b"\x01\x02" + bytes(18)) == "0102"


def test_random_messages():
    for seed in range(10):
        monitor = RemoteIdMonitor(GROUND, 1)
        feed_random_messages(
            monitor, [common.OpenDroneIdArmStatus, common.OpenDroneIdBasicId, common.OpenDroneIdSystem], seed
        )
        monitor.status(START)
