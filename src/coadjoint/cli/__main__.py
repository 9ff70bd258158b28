"""Commands, by ``python -P -m coadjoint.cli``: the same program where no console script is."""

from coadjoint.cli import main

main(prog_name="coadjoint")
