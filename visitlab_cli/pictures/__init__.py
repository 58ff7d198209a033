"""How any picture looks: colours, sizes, words that fit, files that are the same everywhere."""
