"""The parts of `mav shell`: commands, the session that they work on, and what reads the lines."""
