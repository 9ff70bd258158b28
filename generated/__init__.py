"""Generated systems, one package each, importable as ``coadjoint.systems``; written by ``coadjoint regenerate``."""
