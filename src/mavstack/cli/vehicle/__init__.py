"""The command `mav vehicle`."""
