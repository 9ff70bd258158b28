"""Routes: one module for each way from a Spec to its equations of motion.

A route has a function ``derive``, from a Setting to Equations, and ``symbols``, from a Spec to the
names of variables of its own, where it needs any. Its module has the name of the route, which is
registered in `coadjoint.spec.routes`. Read next: `coadjoint.derive.registry`.
"""
