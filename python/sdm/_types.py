"""The words that arguments and results have, for type checkers."""

from typing import Literal

#: How inside and outside are distinguished.
Sign = Literal["automatic", "none", "exact", "winding", "side"]
#: What computes: engines() lists those of this build.
Engine = Literal["cpu", "gl", "gpu", "reference"]
#: Whether a tolerance is met.
Verdict = Literal["pass", "fail", "not decided", "doubtful"]
#: How sure a number is.
Certainty = Literal["exact", "bounded", "estimate"]
