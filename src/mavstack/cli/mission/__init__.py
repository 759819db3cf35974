"""The command `mav mission`."""
