"""The paper: its published curves, whether ours agree, its figures from a run, and the page that tells both."""
