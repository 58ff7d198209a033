"""For whoever writes a kind of agent: a package to begin with, and the questions that an agent is asked."""
