"""The runtime: generated systems as objects that people call, simulate and plot.

Comes in: a generated folder. Goes out: a `System`. SymPy is never imported here, and importing
`coadjoint.solve.system` loads neither NumPy nor SciPy. Read next: `coadjoint.solve.system`.
"""
