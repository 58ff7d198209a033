"""A recorded trial as a scene: in the Rerun viewer, as a file, on the web, as a picture, as a comic strip."""
