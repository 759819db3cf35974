"""`mav terrain`."""
