"""Cross-check: emitted text, NumPy, C and a 50-digit oracle agree, or a rung fails."""
