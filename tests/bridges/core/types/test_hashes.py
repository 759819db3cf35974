"""Type hashes: those that rosidl and rclpy report."""

from __future__ import annotations

import pytest

from mavstack.bridges.core.types import type_hash
from mavstack.errors import InvalidArgumentError

#: Seen in real ROS 2 Kilted, by rclpy or by `rosidl hash`.
KNOWN = {
    "sensor_msgs/msg/NavSatFix": "62223ab3fe210a15976021da7afddc9e200dc9ec75231c1b6a557fc598a65404",
    "sensor_msgs/msg/BatteryState": "4bee5dfce981c98faa6828b868307a0a73f992ed0789f374ee96c8f840e69741",
    "geometry_msgs/msg/PoseStamped": "10f3786d7d40fd2b54367835614bff85d4ad3b5dab62bf8bca0cc232d73b4cd8",
    "geometry_msgs/msg/TwistStamped": "5f0fcd4f81d5d06ad9b4c4c63e3ea51b82d6ae4d0558f1d475229b1121db6f64",
    "geometry_msgs/msg/Twist": "9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a",
    "nav_msgs/msg/Odometry": "3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0",
    "diagnostic_msgs/msg/DiagnosticArray": "5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e",
    "tf2_msgs/msg/TFMessage": "e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087",
    "geographic_msgs/msg/GeoPoseStamped": "a8e603c050fa992a74283bb462a96fe9d2b151b7a67b14d77250ed7cb4ed96b7",
    "mavros_msgs/msg/State": "11ba7686163d22281871f1cb42557e8957407469b0be813bdb1a8922c66e3131",
    "mavros_msgs/srv/CommandBool": "eba73829da4af65d1019131d82f8eccae15d38717bf21409ed5187dd9bae73dc",
    "mavros_msgs/srv/SetMode": "16fc7ce085f4d07d5dd677238b42ef922d2a8aef71fabe6ad18b2ea52c9124da",
}


@pytest.mark.parametrize("name", KNOWN)
def test_hashes_are_those_of_ros(name: str) -> None:
    assert type_hash(name) == f"RIHS01_{KNOWN[name]}"


def test_an_unknown_interface() -> None:
    with pytest.raises(InvalidArgumentError, match="no definition of the interface 'std_msgs/msg/Nonsense'"):
        type_hash("std_msgs/msg/Nonsense")
