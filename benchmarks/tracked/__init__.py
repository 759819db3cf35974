"""A node that tracks one vehicle at the highest rate: latest values, and subscriptions to slow messages."""
