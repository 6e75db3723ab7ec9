"""Emulated time is slow: every wait is for an event, and long."""

PATIENCE_S = 60.0
