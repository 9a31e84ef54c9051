"""Recordings of a flight: schema, writers and readers, tracking report and limits."""
