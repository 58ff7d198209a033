"""The paper's figures from a run, drawn with matplotlib."""
