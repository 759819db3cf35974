"""The command `mav relay`."""
