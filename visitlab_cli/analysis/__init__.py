"""What results mean: summaries over seeds, and whether they are what a config expects."""
