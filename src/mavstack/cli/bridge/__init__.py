"""`mav bridge`."""
