"""`mav simulator`."""
