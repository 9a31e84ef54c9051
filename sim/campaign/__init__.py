"""Campaigns: one scenario flown many times, with other seeds and other values, a row a flight."""
