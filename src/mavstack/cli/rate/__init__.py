"""The command `mav rate`."""
