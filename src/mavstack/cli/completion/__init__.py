"""The command `mav completion`."""
