"""The command `mav key`."""
