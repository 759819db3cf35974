"""MCAP with the profile `ros2`: the topics of vehicles in files that ROS 2 reads, live and from logs."""
