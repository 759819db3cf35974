"""The command `mav radio`."""
