"""What is hazardous besides the mean wind."""
