"""Whether ours agree with the published, and where the cause lies if they don't."""
