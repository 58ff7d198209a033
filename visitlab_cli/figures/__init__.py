"""All pictures of a run as files: the paper's, a grid's, a matrix."""
