"""The command `mav sim`."""
