"""Systems written by `coadjoint regenerate`, one package each."""
