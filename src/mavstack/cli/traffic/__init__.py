"""The command `mav traffic`."""
