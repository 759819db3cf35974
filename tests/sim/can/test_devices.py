from __future__ import annotations

from mavstack.dialects import common
from mavstack.services.can import CanFrame, to_message
from tests.sim.harness import airborne

STATUS = 341


def test_nodes_report_while_the_bus_is_forwarded():
    copter = airborne("copter", "ardupilot")
    assert copter.command(common.MavCmd.CAN_FORWARD, 1) == common.MavResult.ACCEPTED
    copter.receiving = True
    copter.run(2.5)
    frames = [message for message in copter.received if isinstance(message, common.CanFrame)]
    assert {frame.id & 0x7F for frame in frames} == {10, 42, 43}
    copter.received.clear()
    copter.send(to_message(CanFrame(0x1E01AAFF, b"\xc5"), 1, 1, 1))
    copter.run(0.2)
    answers = [message for message in copter.received if isinstance(message, common.CanFrame)]
    assert len(answers) >= 6
    copter.run(10)
    copter.received.clear()
    copter.run(3)
    assert not [message for message in copter.received if isinstance(message, common.CanFrame)]


def test_px4_forwards_no_bus():
    copter = airborne("copter", "px4")
    assert copter.command(common.MavCmd.CAN_FORWARD, 1) == common.MavResult.UNSUPPORTED
