"""The rules: grid, geometry, the human, and the four tasks."""
