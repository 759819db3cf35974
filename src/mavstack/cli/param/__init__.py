"""The command `mav param`."""
