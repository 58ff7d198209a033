"""YAML as text with places: documents, `include`, `key=value`, and problems told where they stand; it knows no task."""
