"""Running cells: build one, play it, workers, progress, continuing."""
