"""Methods that keep the structure of a motion, one module each."""
