"""More agents and humans for visitlab, compiled."""
