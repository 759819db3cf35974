"""`mav web`: the ground station in the browser."""
