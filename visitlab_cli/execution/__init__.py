"""From a config to finished cells: the plan, the workers, progress and resuming."""
