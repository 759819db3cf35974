"""The command `mav watch`."""
