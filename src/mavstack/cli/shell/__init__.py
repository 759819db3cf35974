"""The command `mav shell`."""
