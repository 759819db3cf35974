"""An offboard script as people write it for MAVROS: modes, arming, setpoints, a mission. Plain rclpy.

The last line is JSON: how it went.
"""

from __future__ import annotations

import json
import math
import sys
import time
from typing import Any

import rclpy
from geometry_msgs.msg import PoseStamped, TwistStamped
from mavros_msgs.msg import State, Waypoint
from mavros_msgs.srv import CommandBool, CommandTOL, SetMode, WaypointPull, WaypointPush
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from sensor_msgs.msg import NavSatFix

RATE = 20.0


class Pilot(Node):
    def __init__(self) -> None:
        super().__init__("pilot")
        self.state = State()
        self.pose: PoseStamped | None = None
        self.fix: NavSatFix | None = None
        latched = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.create_subscription(State, "/mavros/state", self._on_state, latched)
        self.create_subscription(
            PoseStamped, "/mavros/local_position/pose", self._on_pose, qos_profile_sensor_data
        )
        self.create_subscription(
            NavSatFix, "/mavros/global_position/global", self._on_fix, qos_profile_sensor_data
        )
        self.position = self.create_publisher(PoseStamped, "/mavros/setpoint_position/local", 10)
        self.velocity = self.create_publisher(TwistStamped, "/mavros/setpoint_velocity/cmd_vel", 10)

    def _on_state(self, message: State) -> None:
        self.state = message

    def _on_pose(self, message: PoseStamped) -> None:
        self.pose = message

    def _on_fix(self, message: NavSatFix) -> None:
        self.fix = message

    def call(self, kind: Any, name: str, **fields: Any) -> Any:
        client = self.create_client(kind, name)
        assert client.wait_for_service(15), name
        request = kind.Request()
        for key, value in fields.items():
            setattr(request, key, value)
        future = client.call_async(request)
        rclpy.spin_until_future_complete(self, future, timeout_sec=20)
        return future.result()

    def spin_until(self, condition: Any, seconds: float, publish: Any = None) -> bool:
        end = time.monotonic() + seconds
        due = 0.0
        while time.monotonic() < end:
            if condition():
                return True
            if publish is not None and time.monotonic() >= due:
                due = time.monotonic() + 1 / RATE
                publish()
            rclpy.spin_once(self, timeout_sec=0.01)
        return bool(condition())

    def hold_at(self, x: float, y: float, z: float) -> None:
        message = PoseStamped()
        message.header.frame_id = "map"
        message.header.stamp = self.get_clock().now().to_msg()
        message.pose.position.x, message.pose.position.y, message.pose.position.z = x, y, z
        message.pose.orientation.w = 1.0
        self.position.publish(message)

    def fly_east(self, speed: float) -> None:
        message = TwistStamped()
        message.header.frame_id = "map"
        message.header.stamp = self.get_clock().now().to_msg()
        message.twist.linear.x = speed
        self.velocity.publish(message)


def main(firmware: str) -> None:
    rclpy.init()
    pilot = Pilot()
    result: dict[str, Any] = {}
    assert pilot.spin_until(lambda: pilot.state.connected and pilot.pose and pilot.fix, 30)
    start = pilot.pose.pose.position
    x, y = start.x, start.y

    def climb() -> None:
        pilot.hold_at(x, y, 5.0)

    if firmware == "px4":
        pilot.spin_until(lambda: False, 1.5, climb)
    mode = "OFFBOARD" if firmware == "px4" else "GUIDED"
    result["armed"] = pilot.spin_until(lambda: try_to_arm(pilot, mode, climb), 30)
    if firmware == "ardupilot":
        assert pilot.call(CommandTOL, "/mavros/cmd/takeoff", altitude=5.0).success
        pilot.spin_until(lambda: pilot.pose.pose.position.z > 4.5, 25)
    pilot.spin_until(lambda: pilot.pose.pose.position.z > 4.5, 25, climb)
    result["height"] = pilot.pose.pose.position.z
    pilot.spin_until(lambda: pilot.pose.pose.position.x - x > 4.0, 15, lambda: pilot.fly_east(2.0))
    position = pilot.pose.pose.position
    result["moved"] = math.hypot(position.x - x, position.y - y)
    items = [waypoint(pilot, index) for index in range(3)]
    assert pilot.call(WaypointPush, "/mavros/mission/push", waypoints=items).success
    result["mission"] = pilot.call(WaypointPull, "/mavros/mission/pull").wp_received
    land = "AUTO.LAND" if firmware == "px4" else "LAND"
    assert pilot.call(SetMode, "/mavros/set_mode", custom_mode=land).mode_sent
    result["landed"] = pilot.spin_until(lambda: not pilot.state.armed, 40)
    print(json.dumps(result))


def try_to_arm(pilot: Pilot, mode: str, publish: Any) -> bool:
    pilot.spin_until(lambda: False, 0.5, publish)
    if pilot.state.mode != mode:
        pilot.call(SetMode, "/mavros/set_mode", custom_mode=mode)
    pilot.spin_until(lambda: pilot.state.mode == mode, 2, publish)
    if not pilot.state.armed:
        pilot.call(CommandBool, "/mavros/cmd/arming", value=True)
    return pilot.spin_until(lambda: pilot.state.armed, 2, publish)


def waypoint(pilot: Pilot, index: int) -> Waypoint:
    fix = pilot.fix
    assert fix is not None
    return Waypoint(
        frame=Waypoint.FRAME_GLOBAL_REL_ALT,
        command=16,
        is_current=index == 0,
        autocontinue=True,
        x_lat=fix.latitude + index * 1e-4,
        y_long=fix.longitude,
        z_alt=10.0,
    )


if __name__ == "__main__":
    main(sys.argv[1])
