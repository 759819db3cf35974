"""`mav map`."""
