"""The command `mav data`."""
