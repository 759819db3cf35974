"""The command `mav dialect`."""
