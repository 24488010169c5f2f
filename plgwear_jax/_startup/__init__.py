"""What only shortens the start: results are the same without it."""
