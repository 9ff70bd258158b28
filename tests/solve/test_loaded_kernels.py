"""`load` returns the very objects that its cross-check ran, and compiles none again."""

import coadjoint
from coadjoint.build import library
from coadjoint.build.compiler import OPTIMIZE
from coadjoint.regenerate import regenerate
from coadjoint.resources import derivations_folder
from coadjoint.solve.folders import load_folder

SPEC = derivations_folder() / "se2_pendulum.toml"


def test_kernels_of_a_loaded_spec_are_those_that_were_checked(tmp_path, monkeypatch):
    """The object of the exact build lies in the cache; after `regenerate` alone it does not."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setenv(OPTIMIZE, "1")  # more than the objects of the ladder
    compiled = []
    compile_kernel = library.compile_kernel

    def counted(*arguments):
        compiled.append(arguments)
        return compile_kernel(*arguments)

    monkeypatch.setattr(library, "compile_kernel", counted)
    regenerate([SPEC], tmp_path / "written")
    load_folder(tmp_path / "written" / SPEC.stem).load_kernels(("c",))
    assert len(compiled) == 1

    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "other"))
    coadjoint.load(SPEC).load_kernels(("c",))
    assert len(compiled) == 1
