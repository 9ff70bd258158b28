"""Bounded forms: the same answers as in this process, and limits that hold."""

import pytest

import coadjoint
from coadjoint import bounded
from coadjoint.errors import CoadjointError, ResourceError, SpecError
from coadjoint.render.document import render_document
from coadjoint.resources import derivations_folder
from tests.specs import RIGID_BODY

BODY = derivations_folder() / "rigid_body.toml"


@pytest.fixture
def body(tmp_path):
    """A spec of a stranger."""
    path = tmp_path / "body.toml"
    path.write_text(RIGID_BODY)
    return path


def test_reading_gives_what_the_spec_declares(body):
    """Names and components as the reader in this process finds them."""
    found = coadjoint.read_bounded(body)
    spec = coadjoint.read_spec(body)
    assert found["state"] == ["Pi1", "Pi2", "Pi3"]
    assert found["parameters"] == ["I1", "I2", "I3"]
    assert (found["title"], found["sha256"]) == (spec.title, spec.sha256)
    assert tuple(found["routes"]) == spec.routes


def test_deriving_and_proving_give_plain_values(body):
    """A document that can be rendered, and a certificate with its claims."""
    document = coadjoint.derive_bounded(body, "lie-poisson")
    assert "lie-poisson" in render_document(document)
    certificate = coadjoint.prove_bounded(body)
    assert certificate["holds"] is True
    statements = {claim["statement"]: claim["verdict"] for claim in certificate["claims"]}
    assert statements["dot(Pi, Pi) is a Casimir"] == "proved"


@pytest.mark.parametrize("form", ["read_bounded", "derive_bounded", "prove_bounded"])
def test_errors_and_limits_reach_the_caller(body, form):
    """A wrong spec raises what it would raise here; a limit of memory is one."""
    with pytest.raises(ResourceError, match=r"(?s)body\.toml: .*32 MiB"):
        getattr(coadjoint, form)(body, memory=2**25)
    body.write_text(RIGID_BODY.replace("Omega, diag", "Omgea, diag"))
    with pytest.raises(SpecError, match="'Omgea'"):
        getattr(coadjoint, form)(body)


def test_one_hostile_spec_keeps_nobody_from_the_others(monkeypatch):
    """Where a child is lost, the spec that it was reading is to blame and no other."""
    real, runs = bounded.run_bounded, []

    def lost(target, paths, *, on_progress, **options):
        runs.append(paths)
        if "hostile.toml" in paths:
            on_progress("read hostile.toml", paths.index("hostile.toml"), len(paths))
            raise ResourceError("hostile.toml: stopped")
        return real(target, paths, on_progress=on_progress, **options)

    monkeypatch.setattr(bounded, "run_bounded", lost)
    paths = [str(BODY), "missing.toml", "hostile.toml", str(BODY)]
    first, second, third, last = bounded.read_all_bounded(paths)
    assert first == last
    assert first["name"] == "rigid_body"
    assert isinstance(second, SpecError)
    assert isinstance(third, ResourceError)
    assert isinstance(third, CoadjointError)
    assert runs == [paths, paths[:2], ["hostile.toml"], paths[3:]]
