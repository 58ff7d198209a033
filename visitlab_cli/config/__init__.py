"""From the user's YAML to a checked, frozen `Config`; `loading.load` is the way in."""
