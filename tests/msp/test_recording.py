"""The replies of a real Betaflight: all are understood, and none loses a byte."""

from __future__ import annotations

from mavstack.msp.commands import MspCommand
from mavstack.msp.messages.pid import Pid
from mavstack.msp.messages.registry import reply_type
from tests.recordings.controller import RecordedController


def test_recorded_replies_decode_and_encode_to_the_same_bytes() -> None:
    controller = RecordedController()
    known = {
        command: (found, payload)
        for command, payload in controller.replies.items()
        if payload and (found := reply_type(command, controller.info)) is not None
    }
    for message, payload in known.values():
        assert message.decode(payload, controller.info).encode(controller.info) == payload, message.NAME
    assert len(known) >= 50


def test_recorded_gains_are_those_of_a_new_betaflight() -> None:
    controller = RecordedController()
    payload = controller.replies[MspCommand.MSP_PID]
    assert payload is not None
    roll, pitch, yaw, *_ = Pid.decode(payload, controller.info).controllers
    assert (roll.p, roll.i, pitch.p, yaw.d) == (45, 80, 47, 0)
