"""The command `mav gimbal`."""
