"""Mask: the object in a drawing, given as a picture or found from the lines.

If a mask is wrong, ``generate --explain FOLDER`` shows at which stage. `preparation.prepare` runs the
stages and chooses between a given mask, the opacity, the lines and the reader. The code of each picture:

1. ``input``: `reading.picture`.
2. ``ink``: `cleaning.ink.clean`, from the reader's output in `cleaning.reader`.
3. ``regions``: `mask.decision.decide`, where each enclosed region gets the mean presence as its vote.
4. ``presence``: the reader itself, `cleaning.reader.read`.
5. ``mask``: `mask.edge.snap`, which moves the vote's edge to the lines, and `pipeline.finish`, which applies
   the user's strokes, and takes the normal network's segmentation if no object was found.
"""

__all__ = []
