"""Limits: how much a spec may ask for, each a named constant.

Comes in: nothing. Goes out: numbers that the reader and the bounded children compare with, each
refusal naming the limit and the place. docs/limits.md is the same table for users, kept equal by a
test. The values are those at which every hostile input that was tried is refused at once and no
system of the literature is.
"""

from __future__ import annotations

# -- the file -------------------------------------------------------------------------------------

#: Bytes of a spec file; some readers of TOML need minutes for a megabyte of nested tables.
SPEC_BYTES = 64 * 1024
#: Levels of tables and arrays in a spec; 30 000 dotted keys in one name cost tomllib 20 seconds.
SPEC_NESTING = 16
#: Characters of a title.
TITLE_CHARACTERS = 200
#: Characters of a unit or a licence expression.
UNIT_CHARACTERS = 40
#: Characters of a name; C promises to tell 31 apart.
NAME_CHARACTERS = 31

# -- numbers --------------------------------------------------------------------------------------

#: Digits of a number before the decimal point.
INTEGER_DIGITS = 40
#: Digits of a number after the decimal point.
DECIMAL_DIGITS = 40

# -- expressions ----------------------------------------------------------------------------------

#: Characters of one expression.
EXPRESSION_CHARACTERS = 4096
#: Open parentheses, calls and signs at one place of an expression.
EXPRESSION_NESTING = 48
#: Numbers, names, operations and calls of one expression.
EXPRESSION_NODES = 1000
#: Parts that definitions put into all expressions of a spec together; a name of one letter may
#: stand for 1000 parts, and a spec has room for thousands of such names.
DEFINED_PARTS = 20_000
#: Size of an exponent, which is a literal integer.
EXPONENT = 32
#: Bits of numerator and denominator of any constant that multiplying out would make.
CONSTANT_BITS = 2048
#: Terms of an expression after multiplying out, estimated from its shape.
EXPANDED_TERMS = 20_000
#: Degree of an expression after multiplying out; a nest of powers has one term and any degree.
EXPANDED_DEGREE = 256
#: Size of a constant that a function such as exp is applied to.
FUNCTION_ARGUMENT = 1000

# -- systems --------------------------------------------------------------------------------------

#: Components of the state.
STATE_COMPONENTS = 256
#: Components of all parameters together.
PARAMETER_COMPONENTS = 256
#: Numbers in all matrices of an algebra or representation together: 64 matrices of 8 by 8.
MATRIX_ENTRIES = 4096
#: Terms that hold parameters in all constants and matrices of an algebra: elimination among four
#: generic 4 by 4 matrices takes 2.5 seconds, among six more than a minute.
PARAMETRIC_TERMS = 64
#: Degree of the number field of all roots, sines and cosines in an algebra, and half the number
#: of parts of a turn in them: sqrt(2), sqrt(3), sqrt(5) and cos(2*pi/7) together have degree 24.
ALGEBRAIC_DEGREE = 24
#: Generators of an algebra given by name or as a product; constants are sparse.
GENERATORS = 5000
#: Generators of an algebra that `coadjoint algebra` examines unless told otherwise: so(9), sp(8)
#: and gl(6) have 36, and the slowest of them, so(9), takes 7 seconds.
EXAMINED_GENERATORS = 36
#: Monomials among which Casimirs are searched; 3 000 take half a second, and so(8) to degree 4
#: has 35 959.
MONOMIALS = 20_000
#: Products of terms of one invariant of matrices; the largest one of so(8) takes 6300.
INVARIANT_TERMS = 25_000
#: Work of one search whose result is not claimed, in operations of exact arithmetic, of which each
#: takes 1 to 15 microseconds; the largest one of a shipped system, the Casimirs of so(8), takes
#: 410 000. See `coadjoint.prove.searches`.
SEARCH_WORK = 2_000_000
#: Work of the part of the search for an invariant measure that compares brackets of conditions,
#: whose long divisions are not counted; the largest one of a shipped system takes 3420, and
#: 100 000 take 8 seconds.
BRACKET_WORK = 50_000
#: Operations of one function after lowering.
OPERATIONS = 20_000
#: Entries of a table of coefficients, which loops run over; so(20) has 6840, and with as many
#: components as a state may have, so(23) would have 10 626.
TABLE_ENTRIES = 20_000
#: Statements in one C function; compilers need minutes for 20 000.
C_STATEMENTS = 3000

#: How many members away a neighbour may be in a sum over members.
NEIGHBOURS = 4
#: Members that an index counts: a state of three components each has 2.4 GB.
FAMILY_MEMBERS = 100_000_000
#: Parts of one formula that is written out for all members: a sum over three indices of 20 members
#: each has 8000 terms, and is written out in a second.
WRITTEN_PARTS = 200_000
#: Members up to which a claim is proved that does not follow for every number of them.
PROVED_MEMBERS = 12

# -- children -------------------------------------------------------------------------------------

#: Seconds of processor time that the derivation of one system may take, unless more are asked for.
WORKER_SECONDS = 120
#: Times as long that it may take by the clock: a machine that is busy with twenty tasks does not
#: count against a spec, and a program that hangs is ended.
WALL_FACTOR = 20
#: Bytes of memory that the derivation of one system may take.
WORKER_BYTES = 2 * 1024**3
#: Seconds of processor time that compiling one kernel may take.
COMPILE_SECONDS = 60
#: Seconds of wall time after which a compiler hangs; a busy machine needs more than the processor.
COMPILE_WALL_SECONDS = 240
#: Bytes of memory that compiling one kernel may take.
COMPILE_BYTES = 2 * 1024**3
#: Bytes of the cache, beyond which what was not used for longest is removed.
CACHE_BYTES = 256 * 1024**2

# -- messages -------------------------------------------------------------------------------------

#: Rows of 80 columns that a message fills at the most: a screen.
MESSAGE_ROWS = 24
