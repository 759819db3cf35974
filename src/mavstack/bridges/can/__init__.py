"""CAN over MAVLink for programs of python-can."""
