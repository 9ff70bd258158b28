"""Group actions that derivations and proofs use: quaternions, vector fields, Galilean motions.

Comes in: components of anything that adds and multiplies. Goes out: rotations, Lie derivatives,
transformed states. Groups with AD, Ad, ad and their duals are theory for library users, in
`coadjoint.theory`. Read next: `coadjoint.groups.quaternions`, `coadjoint.groups.vector_fields`.
"""


def __getattr__(name: str) -> object:
    """No name: what was here is in `coadjoint.theory`."""
    from importlib import import_module

    if name in import_module("coadjoint.theory").__all__:
        raise ImportError(
            f"coadjoint.groups.{name} has moved: import {name} from coadjoint.theory.",
            name="coadjoint.groups",
        )
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
