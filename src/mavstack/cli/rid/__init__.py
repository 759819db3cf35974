"""The command `mav rid`."""
