from __future__ import annotations

from collections import Counter
from contextlib import suppress
from typing import TYPE_CHECKING

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.errors import MspDecodeError
from mavstack.msp import FirmwareInfo
from mavstack.msp.commands import InavCommand, MspCommand
from mavstack.msp.messages.navigation import NavStatus
from mavstack.msp.messages.osd import SetOsdConfig, SetOsdItem, SetOsdTimer
from mavstack.msp.messages.pid import Pid
from mavstack.msp.messages.registry import AREAS, all_messages, messages_of, reply_type, request_types
from mavstack.msp.messages.sensors import Attitude
from tests.msp.messages.strategies import records
from tests.recordings.controller import RecordedController

if TYPE_CHECKING:
    from mavstack.msp.messages.layout import TableMessage

FIRMWARES = (None, FirmwareInfo("BTFL", api=(1, 46)), FirmwareInfo("INAV", api=(2, 5)))


def test_all_areas_of_both_directions_are_there() -> None:
    directions = Counter(message.IS_REPLY for message in all_messages())
    assert directions[True] >= 34
    assert directions[False] >= 21
    assert sum(len(messages_of(area)) for area in AREAS) == len(all_messages())


def test_each_message_has_the_name_of_its_command() -> None:
    for message in all_messages():
        tables = (InavCommand, MspCommand) if message.VARIANTS == ("INAV",) else (MspCommand,)
        assert message.NAME in {name for table in tables for name in table.__members__}, message
        assert message.__doc__


def test_messages_by_command() -> None:
    inav = FirmwareInfo("INAV")
    assert reply_type(MspCommand.MSP_ATTITUDE) is Attitude
    assert (reply_type(MspCommand.MSP_NAV_STATUS), reply_type(MspCommand.MSP_NAV_STATUS, inav)) == (
        None,
        NavStatus,
    )
    assert request_types(MspCommand.MSP_SET_OSD_CONFIG) == (SetOsdConfig, SetOsdItem, SetOsdTimer)
    assert request_types(MspCommand.MSP_ATTITUDE) == ()


@pytest.mark.parametrize("firmware", FIRMWARES, ids=["newest", "Betaflight", "iNav"])
def test_every_message_encodes_what_it_decoded(firmware: FirmwareInfo | None) -> None:
    payload = bytes([2]) * 84
    for message_type in all_messages():
        if (firmware.variant if firmware else "BTFL") in message_type.VARIANTS:
            with suppress(MspDecodeError):  # records of some lists end within a payload of this size
                message = message_type.decode(payload, firmware)
                again = message_type.decode(message.encode(newest(firmware)), firmware)
                assert again == message


@pytest.mark.properties
@given(data=st.data())
def test_encoded_messages_decode_to_the_same(data: st.DataObject) -> None:
    firmware = data.draw(st.sampled_from(FIRMWARES))
    variant = firmware.variant if firmware else "BTFL"
    message_type = data.draw(st.sampled_from([item for item in all_messages() if variant in item.VARIANTS]))
    message: TableMessage = data.draw(records(message_type, firmware))
    payload = message.encode(newest(firmware))
    assert message_type.decode(payload, firmware) == message
    assert message_type.decode(payload, firmware).encode(newest(firmware)) == payload


def newest(firmware: FirmwareInfo | None) -> FirmwareInfo | None:
    """Return the firmware for which no field is left out."""
    return firmware if firmware and firmware.is_inav else None


@pytest.mark.properties
@given(
    message_type=st.sampled_from(all_messages()),
    firmware=st.sampled_from(FIRMWARES),
    payload=st.binary(max_size=64),
)
def test_any_payload_decodes_or_is_refused(
    message_type: type[TableMessage], firmware: FirmwareInfo, payload: bytes
) -> None:
    with suppress(MspDecodeError):
        assert isinstance(message_type.decode(payload, firmware), message_type)


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
