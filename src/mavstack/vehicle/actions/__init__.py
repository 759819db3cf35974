"""What a vehicle does when it is asked, seen through to its end."""
