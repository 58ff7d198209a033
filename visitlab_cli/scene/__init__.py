"""What a moment looks like as shapes and words, once: the viewer, the strip, Foxglove and the report only draw it."""
