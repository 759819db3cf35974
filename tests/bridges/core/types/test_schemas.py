"""Schemas as text."""

from __future__ import annotations

from mavstack.bridges.core.types import interface_names, json_schema, message_text


def test_the_text_has_all_nested_messages() -> None:
    text = message_text("geometry_msgs/msg/TwistStamped")
    parts = text.split("=" * 80 + "\n")
    assert parts[0] == "std_msgs/Header header\ngeometry_msgs/Twist twist\n"
    assert [part.splitlines()[0] for part in parts[1:]] == [
        "MSG: builtin_interfaces/Time",
        "MSG: geometry_msgs/Twist",
        "MSG: geometry_msgs/Vector3",
        "MSG: std_msgs/Header",
    ]


def test_constants_and_bounds_are_kept() -> None:
    assert "uint64[<=33] payload64\n" in message_text("mavros_msgs/msg/Mavlink")
    assert "uint8 FRAMING_OK=1\n" in message_text("mavros_msgs/msg/Mavlink")
    assert "bool read_only false\n" in message_text("rcl_interfaces/msg/ParameterDescriptor")


def test_json_schema() -> None:
    schema = json_schema("sensor_msgs/msg/Imu")
    assert schema["title"] == "sensor_msgs/msg/Imu"
    assert schema["properties"]["orientation"]["properties"]["w"] == {"type": ["number", "null"]}
    covariance = schema["properties"]["orientation_covariance"]
    assert (covariance["minItems"], covariance["maxItems"]) == (9, 9)


def test_all_messages_have_both() -> None:
    for name in interface_names("msg"):
        assert message_text(name)
        assert json_schema(name)["type"] == "object"
