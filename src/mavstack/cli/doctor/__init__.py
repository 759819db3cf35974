"""The command `mav doctor`."""
