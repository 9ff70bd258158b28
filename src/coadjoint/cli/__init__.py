"""Commands: the ``coadjoint`` program. Read next: `coadjoint.cli.program`."""

from coadjoint.cli.program import main

__all__ = ["main"]
