"""Model, analyse and simulate robots that move only because their joints have play.

Lengths are in metres and angles in radians; a quantity carries its unit in its name.

>>> import jointplay as jp
>>> gpr = jp.Gpr.paper()
>>> rods = gpr.inverse(yaw_rad=0.3, pitch_rad=0.02)
>>> pose = gpr.forward(rods.rods_m, "planar")
>>> round(pose.pitch_rad, 12)
0.02
"""

from ._errors import (
    ArgumentTypeError,
    ArrayError,
    ArrayTypeError,
    DependentSidesError,
    FileError,
    GeometryError,
    InputError,
    JointplayError,
    NoAnswerError,
    NotAssembledError,
    NotClosedError,
    NotConvergedError,
    NotFiniteError,
    NotReachedError,
    NotRelievedError,
    OutOfRangeError,
    PitchTooLargeError,
    TooLargeError,
    TurnedOverError,
    UnknownNameError,
)
from ._jointplay import Forward, Gpr, Inverse, __version__
from ._results import (
    Approximate,
    BrokenLimit,
    ForwardMany,
    InverseMany,
    Platform,
)
from ._status import Status
from ._virtualization import VirtualJoint, Virtualization

__all__ = [
    "Approximate",
    "ArgumentTypeError",
    "ArrayError",
    "ArrayTypeError",
    "BrokenLimit",
    "DependentSidesError",
    "FileError",
    "Forward",
    "ForwardMany",
    "GeometryError",
    "Gpr",
    "InputError",
    "Inverse",
    "InverseMany",
    "JointplayError",
    "NoAnswerError",
    "NotAssembledError",
    "NotClosedError",
    "NotConvergedError",
    "NotFiniteError",
    "NotReachedError",
    "NotRelievedError",
    "OutOfRangeError",
    "PitchTooLargeError",
    "Platform",
    "Status",
    "TooLargeError",
    "TurnedOverError",
    "UnknownNameError",
    "VirtualJoint",
    "Virtualization",
    "__version__",
]

for _name in __all__:
    if isinstance(globals()[_name], type):
        # What people see, in messages and pickles, is the package and not its rooms.
        globals()[_name].__module__ = __name__
del _name
