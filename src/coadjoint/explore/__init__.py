"""Explore: a web page that simulates one system with its generated code.

Read next: `coadjoint.explore.page`, then `coadjoint.explore.scene`, which says what is drawn.
"""
