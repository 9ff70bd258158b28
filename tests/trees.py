"""Random trees of a Program: coefficients small, large, negative, 0, of 40 digits."""

from __future__ import annotations

from fractions import Fraction

from hypothesis import strategies as st

from coadjoint.lower.program import FUNCTIONS, Add, Call, Divide, Multiply, Negate, Number, Symbol

NAMES = ("Pi1", "Gamma2", "I3", "_p1", "_t12", "chi_long_name")
FORTY_DIGITS = 10**40

numbers = st.one_of(
    st.integers(-9, 9).map(Fraction),
    st.fractions(0, 1, max_denominator=1000),
    st.builds(Fraction, st.integers(-FORTY_DIGITS, FORTY_DIGITS), st.integers(1, FORTY_DIGITS)),
)


def trees(functions=FUNCTIONS):
    """Trees over every kind of node."""
    leaves = st.one_of(st.sampled_from(NAMES).map(Symbol), numbers.map(Number))

    def grown(inner):
        return st.one_of(
            st.builds(Add, inner, inner),
            st.builds(Add, inner, st.builds(Negate, inner)),
            st.builds(Multiply, inner, inner),
            st.builds(Divide, inner, inner),
            st.builds(Negate, inner),
            st.builds(Call, st.sampled_from([f for f in functions if f != "atan2"]), inner),
            st.builds(Call, st.sampled_from(["atan2"]), inner, inner)
            if "atan2" in functions
            else st.builds(Negate, inner),
        )

    return st.recursive(leaves, grown, max_leaves=40)
