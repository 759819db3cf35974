"""Planning for many vehicles: formations, transitions, avoidance, search, without input and output.

`mavstack.vehicle.swarm` flies these plans. Positions are arrays of metres north, east and up.
"""
