"""The command `mav record`."""
