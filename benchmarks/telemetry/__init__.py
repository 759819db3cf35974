"""Live telemetry: what a message costs from the socket to the program's own function, beside the peers."""
