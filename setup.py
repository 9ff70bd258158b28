"""Packages: every folder of src, and what is mapped into the package from beside it."""

from setuptools import find_packages, setup

#: What travels inside the package, in wheels and in editable installs alike.
MAPPED = {
    "coadjoint.derivations": "derivations",
    "coadjoint.systems": "generated",
    "coadjoint.templates": "templates",
}

setup(
    packages=[
        *find_packages("src"),
        *MAPPED,
        *(f"coadjoint.systems.{name}" for name in find_packages("generated")),
    ],
    package_dir={"coadjoint": "src/coadjoint", **MAPPED},
)
