"""The command `mav demo`."""
