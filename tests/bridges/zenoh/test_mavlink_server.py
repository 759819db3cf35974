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


def test_the_json_of_mavlink2rest() -> None:
    heartbeat = common.Heartbeat(type=2, autopilot=3, base_mode=81, system_status=4, mavlink_version=3)
    found = message_object(packet(heartbeat))
    assert found["header"] == {"system_id": 7, "component_id": 1, "sequence": 3}
    assert found["message"] == {
        "type": "HEARTBEAT",
        "mavtype": {"type": "MAV_TYPE_QUADROTOR"},
        "autopilot": {"type": "MAV_AUTOPILOT_ARDUPILOTMEGA"},
        "base_mode": {"bits": 81},
        "custom_mode": 0,
        "system_status": {"type": "MAV_STATE_ACTIVE"},
        "mavlink_version": 3,
    }
    assert message_object(packet(common.ParamValue(param_id="RTL")))["message"]["param_id"][:4] == [*"RTL\0"]


@pytest.mark.parametrize(
    "message",
    [
        common.Heartbeat(type=6, autopilot=8, base_mode=81, mavlink_version=3),
        common.ParamSet(target_system=1, param_id="RTL_ALT", param_value=15.0),
        common.CommandLong(target_system=1, command=400, param1=1.0),
        common.Statustext(severity=4, text="hello"),
        common.GpsInjectData(target_system=1, len=2, data=bytes(range(110))),
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
