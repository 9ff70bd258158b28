"""Normals: the tables of random words and normal numbers, and how far an implicit step is swept.

Comes in: nothing. Goes out: numbers that templates print and NumPy reads, so that two targets
compute the same. Read next: `coadjoint.solve.normals`.
"""

from __future__ import annotations

from typing import Final

#: J. K. Salmon, M. A. Moraes, R. O. Dror and D. E. Shaw, Parallel random numbers: as easy as 1, 2,
#: 3 (2011): multipliers of Philox4x32, what is added to its key, and its rounds.
MULTIPLIERS: Final = (0xD2511F53, 0xCD9E8D57)
WEYL: Final = (0x9E3779B9, 0xBB67AE85)
ROUNDS: Final = 10
#: Sweeps of the equation of an implicit step, at the most.
SWEEPS: Final = 100

#: M. J. Wichura, Algorithm AS 241, Applied Statistics 37 (1988) 477: numerators and denominators
#: for the middle, the tails, and what is far out, from order 0 on.
MIDDLE: Final = (
    (
        3.3871328727963666080,
        1.3314166789178437745e2,
        1.9715909503065514427e3,
        1.3731693765509461125e4,
        4.5921953931549871457e4,
        6.7265770927008700853e4,
        3.3430575583588128105e4,
        2.5090809287301226727e3,
    ),
    (
        1.0,
        4.2313330701600911252e1,
        6.8718700749205790830e2,
        5.3941960214247511077e3,
        2.1213794301586595867e4,
        3.9307895800092710610e4,
        2.8729085735721942674e4,
        5.2264952788528545610e3,
    ),
)
TAIL: Final = (
    (
        1.42343711074968357734,
        4.63033784615654529590,
        5.76949722146069140550,
        3.64784832476320460504,
        1.27045825245236838258,
        2.41780725177450611770e-1,
        2.27238449892691845833e-2,
        7.74545014278341407640e-4,
    ),
    (
        1.0,
        2.05319162663775882187,
        1.67638483018380384940,
        6.89767334985100004550e-1,
        1.48103976427480074590e-1,
        1.51986665636164571966e-2,
        5.47593808499534494600e-4,
        1.05075007164441684324e-9,
    ),
)
FAR: Final = (
    (
        6.65790464350110377720,
        5.46378491116411436990,
        1.78482653991729133580,
        2.96560571828504891230e-1,
        2.65321895265761230930e-2,
        1.24266094738807843860e-3,
        2.71155556874348757815e-5,
        2.01033439929228813265e-7,
    ),
    (
        1.0,
        5.99832206555887937690e-1,
        1.36929880922735805310e-1,
        1.48753612908506148525e-2,
        7.86869131145613259100e-4,
        1.84631831751005468180e-5,
        1.42151175831644588870e-7,
        2.04426310338993978564e-15,
    ),
)
#: The series of the logarithm, 1/(2 k + 1), and the logarithm of 2 in two parts.
SERIES: Final = tuple(1.0 / (2 * k + 1) for k in range(13))
LOG2: Final = (0.6931471803691238, 1.9082149292705877e-10)
