"""Routes through weather that changes: grid, wind, hazard, search and plan."""
