"""Scenarios, weather sources, the closed loop and the command line."""
