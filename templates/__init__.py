"""Jinja2 templates, one folder for each language; ``numpy`` and ``c`` are twins."""
