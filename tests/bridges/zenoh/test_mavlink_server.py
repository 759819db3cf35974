from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack import Parser
from mavstack.bridges.zenoh.mavlink_server import message_object, packet_of
from mavstack.dialects import Dialect, Message, common
from mavstack.errors import InvalidArgumentError
from tests.bridges.zenoh.test_message_publisher import packet

JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(max_size=4),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=4), inner, max_size=3),
    max_leaves=8,
)


def test_the_json_of_mavlink_server() -> None:
    """Its crate of messages, version 0.16.1, wrote these values for the same packets."""
    heartbeat = common.Heartbeat(type=2, autopilot=3, base_mode=81, system_status=4, mavlink_version=3)
    found = message_object(packet(heartbeat))
    assert found["header"] == {"system_id": 7, "component_id": 1, "sequence": 3, "message_id": 0}
    assert found["message"] == {
        "type": "HEARTBEAT",
        "mavtype": {"type": "MAV_TYPE_QUADROTOR"},
        "autopilot": {"type": "MAV_AUTOPILOT_ARDUPILOTMEGA"},
        "base_mode": "MAV_MODE_FLAG_MANUAL_INPUT_ENABLED | MAV_MODE_FLAG_STABILIZE_ENABLED"
        " | MAV_MODE_FLAG_CUSTOM_MODE_ENABLED",
        "custom_mode": 0,
        "system_status": {"type": "MAV_STATE_ACTIVE"},
        "mavlink_version": 3,
    }
    assert _message(common.ParamValue(param_id="RTL"))["param_id"] == "RTL"
    assert _message(common.Heartbeat())["base_mode"] == ""
    assert _message(common.EscInfo())["failure_flags"] == (0, 0, 0, 0)
    assert _message(common.AttitudeTarget(type_mask=1 + 8 + 16))["type_mask"] == (
        "ATTITUDE_TARGET_TYPEMASK_BODY_ROLL_RATE_IGNORE | 0x18"
    )


def _message(message: Message) -> Any:
    return message_object(packet(message))["message"]


@pytest.mark.parametrize(
    ("base_mode", "value"),
    [({"bits": 81}, 81), ("", 0), ("MAV_MODE_FLAG_SAFETY_ARMED | 0x1", 129), (5, 5)],
)
def test_flags_of_each_version(base_mode: object, value: int) -> None:
    request = {"header": {}, "message": {"type": "HEARTBEAT", "base_mode": base_mode}}
    assert _message_of(request).base_mode == value


def test_texts_of_earlier_versions() -> None:
    letters = [*"RTL_ALT", *("\0" * 9)]
    assert (
        _message_of({"header": {}, "message": {"type": "PARAM_SET", "param_id": letters}}).param_id
        == "RTL_ALT"
    )


def _message_of(request: Any) -> Any:
    (found,) = Parser(Dialect.load("all")).feed(packet_of(request))
    return found.message


@pytest.mark.parametrize(
    "message",
    [
        common.Heartbeat(type=6, autopilot=8, base_mode=81, mavlink_version=3),
        common.ParamSet(target_system=1, param_id="RTL_ALT", param_value=15.0),
        common.CommandLong(target_system=1, command=400, param1=1.0),
        common.Statustext(severity=4, text="hello"),
        common.GpsInjectData(target_system=1, len=2, data=bytes(range(110))),
        common.AttitudeTarget(type_mask=1 + 8 + 16),
        common.EscInfo(failure_flags=(1, 2, 0, 0)),
    ],
    ids=lambda message: type(message).__name__,
)
def test_a_message_comes_back_as_it_was(message: Message) -> None:
    data = packet_of(message_object(packet(message)))
    (back,) = Parser(Dialect.load("all")).feed(data)
    assert (back.system, back.component, back.sequence) == (7, 1, 3)
    assert back.message == message


@given(header=JSON, message=JSON, name=st.sampled_from(["HEARTBEAT", "PARAM_SET", "NOPE", ""]))
def test_other_json_is_refused(header: Any, message: Any, name: str) -> None:
    message = {**message, "type": name} if isinstance(message, dict) else message
    try:
        data = packet_of({"header": header, "message": message})
    except InvalidArgumentError:
        return
    assert len(Parser(Dialect.load("all")).feed(data)) == 1
