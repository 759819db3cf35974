from __future__ import annotations

from mavstack.dialects import common
from mavstack.services import Address
from mavstack.services.serial_control.messages import EXCLUSIVE, RESPOND, message
from tests.sim.harness import airborne

GPS1 = common.SerialControlDev.DEV_GPS1


def replies(copter) -> bytes:
    found = [m for m in copter.received if isinstance(m, common.SerialControl)]
    copter.received.clear()
    return b"".join(bytes(m.data[: m.count]) for m in found)


def test_bytes_come_as_answers_to_requests():
    copter = airborne("copter", "ardupilot")
    copter.receiving = True
    request = message(Address(1, 1), GPS1, RESPOND | EXCLUSIVE)
    copter.send(request)
    copter.run(5)
    assert replies(copter) == b""
    copter.send(request)
    copter.run(0.1)
    assert replies(copter).count(b"$GPGGA") >= 5
    copter.send(message(Address(1, 1), GPS1, 0))  # released
    copter.run(5)
    assert replies(copter) == b""
