"""The published curves, and which of ours belongs to each."""
