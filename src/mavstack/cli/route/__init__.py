"""`mav route`: the router."""
