"""The command `mav log`."""
