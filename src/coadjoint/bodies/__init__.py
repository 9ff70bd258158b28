r"""The lattice of a strand: a spec of rigid bodies in a row, whose limit the strand is.

A strand on SO(3) has an attitude :math:`R(s, t)` at each point, and its energy per length is
:math:`T(\Pi) + V(\Xi)` with :math:`\hat\Xi = R^T \partial_s R`. Bodies at distances a have links
:math:`U = R_i^T R_{i+1}`, rotations whatever the distance is, so that their product around a
ring is 1 exactly. The energy of the lattice, over a, is the sum of T and V over all bodies, with
links in the place of strains (`coadjoint.bodies.energy`).

Comes in: the Spec of a strand. Goes out: the text of a spec with an index; its equations are
derived and proved from that text as those of any spec.
Read next: `coadjoint.bodies.text`.

Source:
    Demoures, Gay-Balmaz and Ratiu, Discrete and Continuous Dynamical Systems S 9 (2016) 1061.
"""

from coadjoint.bodies.text import write_lattice

__all__ = ["write_lattice"]
