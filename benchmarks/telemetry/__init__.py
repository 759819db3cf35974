"""Live telemetry: the cost of a message from the socket to the program's function, compared with peers."""
