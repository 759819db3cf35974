"""The command `mav gen`."""
