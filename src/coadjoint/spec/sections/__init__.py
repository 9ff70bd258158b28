"""Sections: one module for each table of a spec.

Read next: `coadjoint.spec.reader`, which reads them in order.
"""
