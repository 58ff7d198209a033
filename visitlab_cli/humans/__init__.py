"""The humans: one file a kind, each with its parameters, its record and its rules."""
