"""ROS 2: vehicles as MAVROS shows them, over Zenoh, inside ROS, or over DDS."""
