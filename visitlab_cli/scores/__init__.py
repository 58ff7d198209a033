"""The scorecard: questions that are asked of an agent, each with a score from 0 (random) to 1 (the best known)."""
