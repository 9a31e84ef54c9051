"""Where wind fields come from."""
