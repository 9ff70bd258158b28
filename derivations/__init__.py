"""The shipped specs, one TOML file for each system."""
