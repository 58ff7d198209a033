"""The page on what of the paper is reproduced: Markdown whose every number is read from runs."""
