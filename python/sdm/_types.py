"""The words that arguments and results have, for type checkers."""

from typing import Literal

#: How inside and outside are distinguished.
Sign = Literal["automatic", "none", "exact", "winding", "side"]
#: What computes: engines() lists those of this build.
Engine = Literal["cpu", "gl", "reference"]
#: The kinds of an atlas.
Atlas = Literal["charts", "triangles", "uv"]
#: Which point belongs to a texel.
MatchMethod = Literal["closest", "facing", "ray"]
#: Whether a tolerance is met.
Verdict = Literal["pass", "fail", "not decided", "doubtful"]
#: How sure a number is.
Certainty = Literal["exact", "bounded", "estimate"]
#: The colours of distances.
Colormap = Literal["automatic", "viridis", "sequential", "diverging", "paper2006"]
