"""The command `mav serial`."""
