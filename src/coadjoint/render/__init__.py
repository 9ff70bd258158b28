"""Render: Program -> text; templates, one small printer per language, atomic writing."""
