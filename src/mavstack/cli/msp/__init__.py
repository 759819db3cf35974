"""The command `mav msp`."""
