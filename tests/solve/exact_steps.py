"""Steps whose states are a known function of time, for tests of crossings."""

from __future__ import annotations

import numpy as np

from coadjoint.solve.crossings import Watch, join

RTOL, ATOL = 1e-10, 1e-12


class ExactSteps:
    """Steps of some members between times, at which their only state is ``function(t, member)``."""

    degree = 13

    def __init__(self, function, edges, members=1):
        count = len(edges) - 1
        self.function = function
        self.member = np.repeat(np.arange(members), count)
        self.start = np.tile(np.asarray(edges, float)[:-1], members)
        self.size = np.tile(np.diff(edges), members)

    def take(self, which):
        """Some of them."""
        part = ExactSteps(self.function, [0.0, 1.0])
        part.member, part.start, part.size = self.member[which], self.start[which], self.size[which]
        return part

    def follow(self, rows):
        """States at times after the starts of rows."""

        def evaluate(after):
            time = self.start[rows] + after
            member = np.broadcast_to(self.member[rows], time.shape)
            return self.function(time, member)[np.newaxis]

        return evaluate


def find_crossings(function, edges, members=1, at_a_time=None):
    """The crossings of a function, from so many steps of each member in a call."""
    watch = Watch(lambda size: ATOL + RTOL * size, RTOL, members)
    steps = ExactSteps(function, edges, members)
    count = len(edges) - 1
    group = np.arange(len(steps.member)) % count // (at_a_time or count)
    lots = []
    for number in range(group.max() + 1):
        part = steps.take(group == number)

        def value(rows, part=part):
            follow = part.follow(rows)

            def evaluate(share):
                found = follow(share * part.size[rows])[0]
                return found, np.abs(found) + 1.0

            return evaluate

        lots.append(watch.scan(value, part))
    lots += [each for member in range(members) if (each := watch.finish(member)) is not None]
    return join(lots, 1)
