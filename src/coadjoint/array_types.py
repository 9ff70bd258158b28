"""What arrays are called in annotations, whatever their shape.

Read next: `coadjoint.solve.arrays`, which makes some of what people give.
"""

import numpy as np
from numpy.typing import NDArray

#: Real numbers.
Array = NDArray[np.float64]
#: Whether something holds, of each.
Mask = NDArray[np.bool_]
#: Places in other arrays.
Places = NDArray[np.intp]
