"""The command `mav swarm`."""
